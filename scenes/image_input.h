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
  /// Opens a file; colours that it keeps apart from alpha stay so. Throws Error if the file is missing or no image.
  explicit ImageInput(const std::string& path);
  /// Opens a Radiance picture in memory; `path` names it in errors.
  ImageInput(const std::string& path, std::string bytes);

  const OIIO::ImageSpec& spec() const { return spec_; }
  bool is_exr() const { return input_->format_name() == std::string("openexr"); }
  bool seek(int part);  ///< false if there are fewer parts
  /// Channels [first, last) of the current part, channel fastest. Throws Error if a single pixel is missing.
  std::vector<float> read(int first, int last);
  /// Throws Error if there are more pixels than texels can be numbered, or than a file of this size can hold.
  void check_size(long long width, long long height) const;

 private:
  void open(const std::string& name);

  std::string path_, bytes_;  // bytes_ of a picture in memory
  std::uintmax_t file_size_ = 0;
  std::unique_ptr<OIIO::Filesystem::IOMemReader> memory_;  // outlives its reader
  std::unique_ptr<OIIO::ImageInput> input_;
  OIIO::ImageSpec spec_;
  int part_ = 0;
};

}  // namespace penumbra
