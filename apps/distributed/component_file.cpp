// SPDX-License-Identifier: Apache-2.0
#include "apps/distributed/component_file.hpp"

#include <cerrno>
#include <fstream>
#include <span>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include "core/error.hpp"
#include "core/npy_header.hpp"

namespace emberfold::apps {

namespace {

/// A file that the destructor closes.
class Written {
 public:
  Written(const std::filesystem::path& path, int flags)
      : file_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {
    if (file_ < 0) fail(errno);
  }
  ~Written() { ::close(file_); }
  Written(const Written&) = delete;
  Written& operator=(const Written&) = delete;

  void write(const void* data, std::size_t size, std::size_t offset) const {
    const auto* from = static_cast<const char*>(data);
    while (size > 0) {
      const ssize_t some = ::pwrite(file_, from, size, static_cast<off_t>(offset));
      if (some < 0 && errno == EINTR) continue;
      if (some <= 0) fail(some == 0 ? ENOSPC : errno);
      from += some, offset += static_cast<std::size_t>(some), size -= static_cast<std::size_t>(some);
    }
  }
  void take_room(std::size_t size) const {
    const int reason = ::posix_fallocate(file_, 0, static_cast<off_t>(size));
    if (reason != 0) fail(reason);
  }
  void sync() const {
    if (::fdatasync(file_) != 0) fail(errno);
  }

 private:
  [[noreturn]] static void fail(int reason) {
    throw core::IoError(std::string("cannot write C.npy: ") + std::generic_category().message(reason));
  }
  int file_;
};

}  // namespace

std::string ComponentFile::header(Eigen::Index n) const {
  return core::npy_header({{values_, static_cast<std::size_t>(n)}, true, std::span<const float>()});
}

void ComponentFile::begin(Eigen::Index n) const {
  const Written file(path_, O_WRONLY | O_CREAT | O_TRUNC);
  const std::string text = header(n);
  file.take_room(text.size() + values_ * static_cast<std::size_t>(n) * sizeof(float));
  file.write(text.data(), text.size(), 0);
}

void ComponentFile::put(std::size_t first, const Eigen::MatrixXf& rows) const {
  const Written file(path_, O_WRONLY);
  const std::size_t begin = header(rows.cols()).size();
  for (Eigen::Index j = 0; j < rows.cols(); ++j)
    file.write(rows.col(j).data(), static_cast<std::size_t>(rows.rows()) * sizeof(float),
               begin + (static_cast<std::size_t>(j) * values_ + first) * sizeof(float));
  file.sync();
}

Eigen::MatrixXf ComponentFile::first_columns(Eigen::Index count, Eigen::Index n) const {
  Eigen::MatrixXf columns(static_cast<Eigen::Index>(values_), count);
  std::ifstream in(path_, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(header(n).size()));
  in.read(reinterpret_cast<char*>(columns.data()),
          static_cast<std::streamsize>(columns.size()) * static_cast<std::streamsize>(sizeof(float)));
  if (!in) throw core::IoError("cannot read C.npy again");
  return columns;
}

}  // namespace emberfold::apps
