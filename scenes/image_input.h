// OpenImageIO's readers behind a guard: whatever they say, throw or leave unsaid becomes an Error that names the file.
#pragma once

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <memory>
#include <string>
#include <vector>

namespace penumbra {

class ImageInput {
 public:
  /// Colours that the file keeps apart from alpha stay so. Throws Error if the file is missing or no image.
  explicit ImageInput(const std::string& path);
  /// A Radiance picture in memory; `path` names it in errors.
  ImageInput(const std::string& path, std::string bytes);

  const OIIO::ImageSpec& spec() const { return spec_; }
  bool is_exr() const { return input_->format_name() == std::string("openexr"); }
  bool seek(int part);  ///< false if there are fewer parts
  /// Channels [first, last) of the current part, channel fastest. Throws Error if a single pixel is missing.
  std::vector<float> read(int first, int last);

 private:
  void check_size() const;

  std::string path_, bytes_;
  std::uintmax_t file_size_ = 0;
  std::unique_ptr<OIIO::Filesystem::IOMemReader> memory_;  // outlives its reader
  std::unique_ptr<OIIO::ImageInput> input_;
  OIIO::ImageSpec spec_;
  int part_ = 0;
};

/// Throws Error if an image of this size is beyond what texels are numbered with, or memory holds.
void check_image_size(long long width, long long height, const std::string& path);

}  // namespace penumbra
