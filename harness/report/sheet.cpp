#include "harness/report/sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "harness/report/row_text.h"
#include "harness/report/screen.h"
#include "harness/results/pictures.h"
#include "harness/results/text.h"
#include "scenes/log.h"

namespace penumbra {
namespace {

constexpr int widest = 256, narrowest = 176;  // of a panel, and of a column of the sheet
constexpr int gap = 10;
constexpr int letters = 13, line_height = 17, title_letters = 16, title_height = 28;
constexpr int bar_height = 14, legend_height = bar_height + 4 * line_height;

/// What one column shows; the truth has no error.
struct Panel {
  std::vector<std::string> caption;
  Image image, error;
};

std::string error_text(const Row& row) {
  const auto at = row.score.errors.find("truth");
  if (at == row.score.errors.end()) return "";
  if (at->second.tie()) return fmt::format("< {:.2g} % (tie)", 100.0 * at->second.floor());
  const auto& error = at->second.report.all.rel_rmse;
  return percent_text(error) + (error ? " %" : "");
}

std::string figures(const Row& row) {
  std::string error = error_text(row);
  if (row.timing.frame_ms.empty()) return error;
  return three_digits(row.timing.median_frame_ms()) + " ms" + (error.empty() ? "" : ", " + error);
}

std::vector<std::string> caption_of(const Row& row, const std::vector<const Row*>& rows, const Lettering& lettering,
                                    int width) {
  const std::string label = short_label(row, rows), name = row.id.technique;
  std::vector<std::string> lines = {lettering.fitted(name, width, letters)};
  for (const std::string& line : lettering.wrapped(label.substr(name.size()), width, letters, 2)) lines.push_back(line);
  lines.push_back(lettering.fitted(figures(row), width, letters));
  return lines;
}

/// "±0.19 %" of the truth that rows were compared with.
std::string noise_text(const Row& row) {
  const auto at = row.score.errors.find("truth");
  if (at == row.score.errors.end() || !at->second.rel_noise) return "";
  return fmt::format("±{:.2g} %", 100.0 * *at->second.rel_noise);
}

std::string title_of(const std::vector<const Row*>& rows) {
  std::vector<std::string> spheres;
  for (const Row* row : rows)
    if (row->id.reads_spheres && row->id.spheres > 0) add_distinct(spheres_text(row->id), spheres);
  std::string text =
      fmt::format("{}: {} receivers", rows.front()->id.scene, with_thousands(rows.front()->id.receivers));
  if (spheres.size() == 1) text += fmt::format(", spheres: {}", spheres.front());
  return text;
}

std::string beside(const std::string& image, const char* name) {
  return (std::filesystem::path(image).parent_path() / name).string();
}

/// Empty if the file cannot be read, or is of vertices.
Image read_panel(const std::string& file) {
  try {
    const Image image = load_picture(file);
    return image.height == 1 ? Image() : panel(image, widest);
  } catch (const std::exception&) {
    return {};
  }
}

/// The colours of signed errors from -1/4 to 1/4 of white.
Image colour_bar(int width) {
  Image values{width, bar_height, {}}, zero = values;
  for (int i = 0; i < width * bar_height; ++i)
    values.pixels.emplace_back(float(signed_error_range * (2.0 * (i % width) / (width - 1) - 1.0)));
  zero.pixels.assign(values.pixels.size(), vec3(0.0f));
  return signed_error(values, zero, 1.0);
}

/// One scene: its truth and its rows.
class Part {
 public:
  Part(const std::string& folder, const std::vector<const Row*>& rows, const Lettering& lettering)
      : lettering_(lettering) {
    for (const Row* row : rows) {
      Panel p{{},
              read_panel(folder + "/" + row->facts.image + ".png"),
              read_panel(folder + "/" + row->facts.image + ".error.png")};
      if (row->facts.image.empty() || p.image.pixels.empty()) continue;
      shown_.push_back(row);
      panels_.push_back(std::move(p));
    }
    if (shown_.empty()) return;
    Panel truth{{}, read_panel(folder + "/" + beside(shown_.front()->facts.image, "truth.png")), {}};
    panels_.insert(panels_.begin(), std::move(truth));
    for (const Panel& p : panels_) {
      column_ = std::max(column_, p.image.width);
      image_height_ = std::max(image_height_, p.image.height);
    }
    if (!lettering.available()) return;
    panels_.front().caption = {"truth", noise_text(*shown_.front())};
    for (std::size_t k = 0; k < shown_.size(); ++k)
      panels_[k + 1].caption = caption_of(*shown_[k], shown_, lettering, column_);
  }

  bool empty() const { return panels_.empty(); }
  int column() const { return column_; }
  /// At most so many, and as few as make no more lines of panels.
  std::size_t columns(std::size_t most) const {
    const std::size_t lines = (panels_.size() + most - 1) / most;
    return (panels_.size() + lines - 1) / lines;
  }
  int height(std::size_t columns) const {
    int height = top();
    for (std::size_t k = 0; k < panels_.size(); k += columns) height += block_height(k, columns);
    return height;
  }

  void draw(std::size_t columns, int y, Image& sheet) const {
    lettering_.draw(lettering_.fitted(title_of(shown_), sheet.width - 2 * gap, title_letters), gap,
                    y + title_height - 8, title_letters, sheet);
    y += top();
    for (std::size_t k = 0; k < panels_.size(); k += columns) {
      const std::size_t end = std::min(panels_.size(), k + columns);
      for (std::size_t p = k; p < end; ++p)
        draw_panel(panels_[p], p == 0, gap + int(p - k) * (column_ + gap), y + caption_height(k, columns), sheet);
      y += block_height(k, columns);
    }
  }

 private:
  int top() const { return lettering_.available() ? title_height : gap; }
  int error_height() const { return std::max(image_height_, lettering_.available() ? legend_height : bar_height); }
  int caption_height(std::size_t first, std::size_t columns) const {
    std::size_t lines = 0;
    for (std::size_t k = first; k < std::min(panels_.size(), first + columns); ++k)
      lines = std::max(lines, panels_[k].caption.size());
    return int(lines) * line_height + (lines > 0 ? 4 : 0);
  }
  int block_height(std::size_t first, std::size_t columns) const {
    return caption_height(first, columns) + image_height_ + gap + error_height() + 2 * gap;
  }

  /// The image begins at (x, y), its caption ends there, its error or the legend stands below.
  void draw_panel(const Panel& p, bool truth, int x, int y, Image& sheet) const {
    for (std::size_t line = 0; line < p.caption.size(); ++line)
      lettering_.draw(p.caption[line], x, y - 7 - int(p.caption.size() - 1 - line) * line_height, letters, sheet);
    paste(p.image, x, y, sheet);
    y += image_height_ + gap;
    if (truth) draw_legend(x, y, sheet);
    else paste(p.error, x, y, sheet);
  }

  void draw_legend(int x, int y, Image& sheet) const {
    paste(colour_bar(column_), x, y, sheet);
    const int share = int(100.0 * signed_error_range);
    const std::string least = fmt::format("-{} %", share), most = fmt::format("+{} %", share);
    const int baseline = y + bar_height + line_height - 3;
    lettering_.draw(least, x, baseline, letters, sheet);
    lettering_.draw("0", x + (column_ - lettering_.width("0", letters)) / 2, baseline, letters, sheet);
    lettering_.draw(most, x + column_ - lettering_.width(most, letters) - 1, baseline, letters, sheet);
    int line = 1;
    for (const char* text : {"image - truth, of white", "blue: too dark", "red: too bright"})
      lettering_.draw(lettering_.fitted(text, column_, letters), x, baseline + line++ * line_height, letters, sheet);
  }

  const Lettering& lettering_;
  std::vector<const Row*> shown_;
  std::vector<Panel> panels_;  ///< the truth, then one for each row that is shown
  int column_ = narrowest, image_height_ = 0;
};

}  // namespace

Image draw_sheet(const std::string& folder, const std::vector<std::vector<const Row*>>& parts, int columns,
                 const Lettering& lettering) {
  std::vector<Part> drawn;
  std::size_t most = 0;
  int column = 0, height = 0;
  for (const std::vector<const Row*>& rows : parts) {
    const Part& part = drawn.emplace_back(folder, rows, lettering);
    if (part.empty()) {
      drawn.pop_back();
      continue;
    }
    most = std::max(most, part.columns(std::size_t(columns)));
    column = std::max(column, part.column());
    height += part.height(part.columns(std::size_t(columns)));
  }
  if (drawn.empty()) return {};
  static bool warned = false;
  if (!lettering.available() && !std::exchange(warned, true))
    warn("no font for labels: pictures come without them; install one (Debian: fonts-dejavu-core)");
  Image sheet{int(most) * (column + gap) + gap, height, {}};
  sheet.pixels.assign(std::size_t(sheet.width) * sheet.height, vec3(1.0f));
  int y = 0;
  for (const Part& part : drawn) {
    const std::size_t own = part.columns(std::size_t(columns));
    part.draw(own, y, sheet);
    y += part.height(own);
  }
  return sheet;
}

void save_overview(const std::string& folder, const std::string& images, const std::vector<Row>& rows) {
  constexpr int columns = 6;
  std::vector<const Row*> shown;
  for (const Row& row : rows)
    if (row.ok() && std::filesystem::path(row.facts.image).parent_path() == images) shown.push_back(&row);
  try_to_save([&] {
    const Image sheet = draw_sheet(folder, {shown}, columns);
    if (!sheet.pixels.empty()) save_png(folder + "/" + images + "/overview.png", sheet);
  });
}

}  // namespace penumbra
