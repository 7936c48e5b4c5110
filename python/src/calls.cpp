// SPDX-License-Identifier: Apache-2.0
#include "python/src/calls.hpp"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace emberfold::python {

namespace {

/// Messages of a working thread to the thread that waits.
class Letterbox {
 public:
  struct Letters {
    std::vector<std::string> warnings;
    std::vector<std::pair<std::string, double>> progress;
    bool done = false;
  };

  void warn(const std::string& text) {
    const std::lock_guard lock(mutex_);
    letters_.warnings.push_back(text);
  }
  void report(std::string_view stage, double fraction) {
    const std::lock_guard lock(mutex_);
    auto& progress = letters_.progress;
    // Only the newest share of a stage is of interest.
    if (progress.empty() || progress.back().first != stage) progress.emplace_back(stage, fraction);
    progress.back().second = fraction;
  }
  void end() {
    const std::lock_guard lock(mutex_);
    letters_.done = true;
    ended_.notify_one();
  }
  /// Waits a moment, less if the work ends, and takes what there is.
  Letters take() {
    std::unique_lock lock(mutex_);
    ended_.wait_for(lock, std::chrono::milliseconds(50), [&] { return letters_.done; });
    Letters taken = std::exchange(letters_, {});
    letters_.done = taken.done;
    return taken;
  }

 private:
  std::mutex mutex_;
  std::condition_variable ended_;
  Letters letters_;
};

void deliver(const Letterbox::Letters& letters, const py::object& progress) {
  constexpr py::ssize_t kCallerOfPackage = 2;
  for (const auto& text : letters.warnings)
    if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), kCallerOfPackage) < 0) throw py::error_already_set();
  if (!progress.is_none())
    for (const auto& [stage, fraction] : letters.progress) progress(stage, fraction);
  if (PyErr_CheckSignals() < 0) throw py::error_already_set();
}

/// A thread that is asked to stop and waited for, without the interpreter's lock, however it is left.
class Worker {
 public:
  Worker(Letterbox& letterbox, const std::function<void(const core::Context&)>& work)
      : thread_([this, &letterbox, &work](std::stop_token stop) {
          const core::Context context(
              std::move(stop),
              [&](std::string_view stage, double fraction) { letterbox.report(stage, fraction); },
              [&](const std::string& text) { letterbox.warn(text); });
          try {
            work(context);
          } catch (...) {
            failure_ = std::current_exception();
          }
          letterbox.end();
        }) {}
  ~Worker() {
    PyThreadState* const lock = PyEval_SaveThread();  // pybind11's way may throw
    thread_ = std::jthread();                         // asks it to stop, and waits
    PyEval_RestoreThread(lock);
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  void join() {
    const py::gil_scoped_release released;
    if (thread_.joinable()) thread_.join();
  }
  [[nodiscard]] const std::exception_ptr& failure() const { return failure_; }

 private:
  std::exception_ptr failure_;
  std::jthread thread_;
};

}  // namespace

void run_interruptibly(const py::object& progress, const std::function<void(const core::Context&)>& work) {
  Letterbox letterbox;
  Worker worker(letterbox, work);
  for (bool done = false; !done;) {
    Letterbox::Letters letters;
    {
      const py::gil_scoped_release released;
      letters = letterbox.take();
    }
    done = letters.done;
    deliver(letters, progress);
  }
  worker.join();
  if (worker.failure()) std::rethrow_exception(worker.failure());
}

}  // namespace emberfold::python
