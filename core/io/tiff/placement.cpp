// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/error.hpp"
#include "core/io/tiff/axes.hpp"

namespace emberfold::io {

namespace {

constexpr int kMissing = -1;

/// Puts pages into the planes of the axes, in the order of the file.
class Placement {
 public:
  Placement(const std::string& order, TiffAxes& axes) : axes_(axes) {
    for (const char c : order) {
      order_.push_back(c);
      sizes_.push_back(c == 'C' ? axes.channels : c == 'Z' ? axes.slices : axes.frames);
    }
    axes_.planes.assign(count(), kMissing);
  }

  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(axes_.channels) * static_cast<std::size_t>(axes_.slices) *
           static_cast<std::size_t>(axes_.frames);
  }

  void place(const PageRun& run, std::size_t pages) {
    const auto first = static_cast<std::size_t>(run.page.value_or(0));
    const auto planes = static_cast<std::size_t>(run.planes.value_or(run.page ? 1 : static_cast<int>(pages)));
    std::size_t at = 0, stride = 1;
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const int begin = order_[i] == 'C' ? run.channel : order_[i] == 'Z' ? run.slice : run.frame;
      at += static_cast<std::size_t>(begin) * stride;
      stride *= static_cast<std::size_t>(sizes_[i]);
    }
    for (std::size_t k = 0; k < planes && first + k < pages && at + k < count(); ++k)
      axes_.planes[plane(at + k)] = static_cast<int>(first + k);
  }

 private:
  /// Returns the place in our order of a place in the file's.
  [[nodiscard]] std::size_t plane(std::size_t at) const {
    std::size_t channel = 0, slice = 0, frame = 0;
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const auto size = static_cast<std::size_t>(sizes_[i]);
      (order_[i] == 'C' ? channel : order_[i] == 'Z' ? slice : frame) = at % size;
      at /= size;
    }
    const auto slices = static_cast<std::size_t>(axes_.slices),
               channels = static_cast<std::size_t>(axes_.channels);
    return (frame * slices + slice) * channels + channel;
  }

  TiffAxes& axes_;
  std::string order_;
  std::vector<int> sizes_;
};

/// Drops frames at the end that were planned but never recorded; a gap before others is an error. Frames may
/// be called slices or channels.
void drop_missing(const std::filesystem::path& path, TiffAxes& axes) {
  int& frames = axes.frames > 1 ? axes.frames : axes.slices > 1 ? axes.slices : axes.channels;
  const int planned = frames;
  const std::size_t each = axes.planes.size() / static_cast<std::size_t>(planned);
  const auto last = [&] {
    return std::find(axes.planes.end() - static_cast<std::ptrdiff_t>(each), axes.planes.end(), kMissing);
  };
  while (frames > 1 && last() != axes.planes.end()) {
    axes.planes.resize(axes.planes.size() - each);
    --frames;
  }
  if (frames < planned)
    axes.doubts.push_back("only " + std::to_string(frames) + " of the " + std::to_string(planned) +
                          " frames that its head claims are whole");
  const auto gap = std::ranges::find(axes.planes, kMissing);
  if (gap != axes.planes.end())
    throw core::IoError("cannot read " + path.string() + ": a plane of its frame " +
                        std::to_string(static_cast<std::size_t>(gap - axes.planes.begin()) / each) +
                        " is missing");
}

}  // namespace

void place_pages(const std::filesystem::path& path, const std::string& order,
                 const std::vector<PageRun>& runs, std::size_t pages, TiffAxes& axes) {
  Placement placement(order, axes);
  for (const PageRun& run : runs) placement.place(run, pages);
  drop_missing(path, axes);
}

}  // namespace emberfold::io
