#include "scenes/image_input.h"

#include <algorithm>
#include <filesystem>

#include "scenes/error.h"

namespace penumbra {
namespace {

/// A library's words on one line.
std::string one_line(std::string text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

template <class Call>
auto guarded(const std::string& path, Call call) {
  try {
    return call();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw Error("{}: cannot be read as an image ({})", path, one_line(e.what()));
  }
}

[[noreturn]] void fail_to_open(const std::string& path, const std::string& reason) {
  for (const char* chroma : {"\"BY\" has sampling", "\"RY\" has sampling"})
    if (reason.find(chroma) != std::string::npos)
      throw Error(
          "{}: is stored as luminance and chroma (Y, RY, BY) with fewer samples of chroma, which is not read; save it "
          "with channels R, G, B",
          path);
  throw Error("{}: cannot be read as an image ({})", path, reason);
}

}  // namespace

ImageInput::ImageInput(const std::string& path) : path_(path) {
  if (!std::filesystem::exists(path)) throw Error("{}: no such image file", path);
  if (std::filesystem::is_directory(path)) throw Error("{}: is a folder, not an image file", path);
  file_size_ = std::filesystem::file_size(path);
  if (file_size_ == 0) throw Error("{}: the image file is empty", path);
  open(path);
}

ImageInput::ImageInput(const std::string& path, std::string bytes)
    : path_(path),
      bytes_(std::move(bytes)),
      file_size_(bytes_.size()),
      memory_(std::make_unique<OIIO::Filesystem::IOMemReader>(bytes_.data(), bytes_.size())) {
  open("picture.hdr");
}

void ImageInput::open(const std::string& name) {
  OIIO::ImageSpec wishes;
  wishes.attribute("oiio:UnassociatedAlpha", 1);
  // With wishes, the Radiance reader looks for a file.
  guarded(path_, [&] { input_ = OIIO::ImageInput::open(name, memory_ ? nullptr : &wishes, memory_.get()); });
  if (!input_) fail_to_open(path_, one_line(OIIO::geterror()));
  spec_ = input_->spec();
  check_size(spec_.width, spec_.height);
  if (spec_.nchannels <= 0) throw Error("{}: the image is empty", path_);
}

void ImageInput::check_size(long long width, long long height) const {
  constexpr long long most = 1 << 29;  // 32768 x 16384
  if (width <= 0 || height <= 0) throw Error("{}: the image is empty", path_);
  if (width > most || height > most || width * height > most)
    throw Error("{}: {} x {} pixels are more than the {} that an image may have; make it smaller", path_, width, height,
                most);
  // No compression goes as far as 65536 pixels in a byte: refused before memory is asked for.
  if (std::uintmax_t(width * height) >> 16 > file_size_)
    throw Error("{}: the image is damaged: it claims {} x {} pixels in {} bytes", path_, width, height, file_size_);
}

bool ImageInput::seek(int part) {
  const bool there = guarded(path_, [&] { return input_->seek_subimage(part, 0); });
  input_->geterror();  // that there are no more parts is none
  if (!there) return false;
  part_ = part;
  spec_ = input_->spec();
  check_size(spec_.width, spec_.height);
  return true;
}

std::vector<float> ImageInput::read(int first, int last) {
  return guarded(path_, [&] {
    std::vector<float> values(std::size_t(spec_.width) * spec_.height * (last - first));
    const bool read = input_->read_image(part_, 0, first, last, OIIO::TypeDesc::FLOAT, values.data());
    // Some readers fill up what is missing, and only say so.
    const std::string complaint = one_line(input_->geterror());
    if (!read || !complaint.empty())
      throw Error("{}: the image is damaged or cut short ({})", path_,
                  complaint.empty() ? "no reason given" : complaint);
    return values;
  });
}

}  // namespace penumbra
