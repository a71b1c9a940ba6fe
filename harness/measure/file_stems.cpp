#include "harness/measure/file_stems.h"

#include <fmt/format.h>

#include <set>

#include "scenes/names.h"
#include "scenes/storage/content_key.h"

namespace penumbra {
namespace {

/// 255 bytes without `.error.png` or `.sheet.png` behind.
constexpr std::size_t longest_stem = 255 - 10;

std::string with_digest(const std::string& label) {
  ContentHash hash;
  hash.add(label);
  const std::string tail = fmt::format("-{:.12}", hash.digest());
  return file_name(label).substr(0, longest_stem - tail.size()) + tail;
}

}  // namespace

std::map<std::string, std::string> file_stems(const std::vector<Variant>& variants) {
  std::map<std::string, std::set<std::string>> labels;  // by what could be the same file
  for (const Variant& variant : variants) labels[file_name_key(variant.label())].insert(variant.label());
  std::map<std::string, std::string> stems;
  for (const auto& [key, same] : labels)
    for (const std::string& label : same)
      stems[label] = same.size() > 1 || label.size() > longest_stem ? with_digest(label) : file_name(label);
  return stems;
}

}  // namespace penumbra
