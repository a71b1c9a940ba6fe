#include "scenes/radiance_header.h"

#include <cctype>
#include <cmath>
#include <optional>
#include <sstream>

#include "scenes/error.h"
#include "scenes/pattern.h"

namespace penumbra {
namespace {

constexpr std::size_t longest_header = std::size_t(1) << 20;

/// One line without its end, which may be Windows'; moves `at` behind it. Nothing if the bytes end before the line
/// does.
std::optional<std::string> next_line(const std::string& bytes, std::size_t& at) {
  const std::size_t end = bytes.find('\n', at);
  if (end == std::string::npos || end > longest_header) return std::nullopt;
  std::string line = bytes.substr(at, end - at);
  at = end + 1;
  while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.pop_back();
  return line;
}

/// For messages: the part of a line that is text.
std::string quoted(const std::string& line) {
  std::string text = line.substr(0, 60);
  for (char& c : text)
    if (std::iscntrl(static_cast<unsigned char>(c)) || static_cast<unsigned char>(c) > 126) c = '?';
  return text;
}

/// As many numbers as there are in `values`, positive if they must be.
template <std::size_t count>
void read_numbers(const std::string& name, const std::string& text, bool positive, double (&values)[count],
                  const std::string& path) {
  std::istringstream in(text);
  std::string rest;
  bool good = true;
  for (double& value : values) good = good && (in >> value) && std::isfinite(value) && (!positive || value > 0.0);
  if (!good || (in >> rest))
    throw Error("{}: the header's {} is '{}', which should be {} {}number{}", path, name, quoted(text), count,
                positive ? "positive " : "", count > 1 ? "s" : "");
}

void read_variable(const std::string& name, const std::string& text, const std::string& path, RadianceHeader& header) {
  double one[1], three[3], eight[8];
  if (name == "FORMAT") {
    header.xyz = text == "32-bit_rle_xyze";
    if (!header.xyz && text != "32-bit_rle_rgbe")
      throw Error("{}: the header's FORMAT is '{}'; Radiance pictures are 32-bit_rle_rgbe or 32-bit_rle_xyze", path,
                  quoted(text));
  } else if (name == "EXPOSURE") {
    read_numbers(name, text, true, one, path);
    header.exposure *= one[0];
  } else if (name == "COLORCORR") {
    read_numbers(name, text, true, three, path);
    header.correction *= glm::dvec3(three[0], three[1], three[2]);
  } else if (name == "GAMMA") {
    read_numbers(name, text, true, one, path);
    header.gamma = one[0];
  } else if (name == "PRIMARIES") {
    read_numbers(name, text, false, eight, path);
    header.primaries = chromaticities_from(eight);
  }  // VIEW, PIXASPECT, SOFTWARE, ...: nothing that an environment depends on
}

void read_resolution(const std::string& line, const std::string& path, RadianceHeader& header) {
  static const Pattern form("form", R"(\s*([-+])([XY])\s+(\d{1,9})\s+([-+])([XY])\s+(\d{1,9}))");
  const std::vector<std::string> part = form.parts_of(line);
  if (part.empty() || part[2] == part[5])
    throw Error("{}: the resolution line is '{}', which should be such as '-Y 512 +X 1024'", path, quoted(line));
  header.height = std::stoi(part[3]), header.width = std::stoi(part[6]);
  if (header.width == 0 || header.height == 0) throw Error("{}: the image is empty", path);
  const auto sign = [&](const char* axis) { return (part[2] == axis ? part[1] : part[4]).front(); };
  // Y points up: a picture whose rows go to +Y begins at the bottom.
  header.orientation = {part[2] == "X", sign("X") == '-', sign("Y") == '+'};
}

}  // namespace

bool is_radiance_picture(const std::string& bytes) {
  if (bytes.starts_with("#?")) return true;
  const std::string start = bytes.substr(0, 4096);
  return start.substr(0, start.find('\0')).find("FORMAT=32-bit_rle_") != std::string::npos;
}

RadianceHeader read_radiance_header(const std::string& bytes, const std::string& path) {
  // Without a space in front: lines that were moved in tell of the pictures which this one was made from.
  static const Pattern form("form", R"(([A-Z]+)[ \t]*=[ \t]*(.*))");
  RadianceHeader header;
  std::optional<std::string> line;
  while ((line = next_line(bytes, header.size)) && !line->empty()) {
    if (line->size() >= 4096) continue;
    const std::vector<std::string> part = form.parts_of(*line);
    if (!part.empty()) read_variable(part[1], part[2], path, header);
  }
  if (!line) throw Error("{}: the header of this Radiance picture does not end (an empty line ends it)", path);
  line = next_line(bytes, header.size);
  if (!line) throw Error("{}: the image is cut short: its header has no resolution line", path);
  read_resolution(*line, path, header);
  return header;
}

std::string plain_radiance_picture(const RadianceHeader& header, const std::string& bytes) {
  return fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", header.height, header.width) +
         bytes.substr(header.size);
}

}  // namespace penumbra
