// SPDX-License-Identifier: Apache-2.0
#include "dytex/distributed/together.hpp"

#include <algorithm>
#include <array>
#include <new>
#include <string>
#include <utility>

#include "core/context.hpp"
#include "core/error.hpp"

namespace emberfold::dytex {

namespace {

enum class Kind : std::int64_t { none, input, io, numerical, cancelled, memory, other };

/// A rank's message to all others: its value, or its error and the length of the error's text.
struct Told {
  std::int64_t value = 0;
  Kind kind = Kind::none;
  std::int64_t length = 0;
};

struct Failure {
  Kind kind = Kind::none;
  std::string text;
};

Failure caught(const std::function<void()>& body) {
  try {
    body();
    return {};
  } catch (const core::InputError& error) {
    return {Kind::input, error.what()};
  } catch (const core::IoError& error) {
    return {Kind::io, error.what()};
  } catch (const core::NumericalError& error) {
    return {Kind::numerical, error.what()};
  } catch (const core::Cancelled& stopped) {
    return {Kind::cancelled, stopped.kept};
  } catch (const std::bad_alloc&) {
    return {Kind::memory, {}};
  } catch (const std::exception& error) {
    return {Kind::other, error.what()};
  }
}

std::exception_ptr exception_of(const Failure& failure) {
  switch (failure.kind) {
    case Kind::input:
      return std::make_exception_ptr(core::InputError(failure.text));
    case Kind::io:
      return std::make_exception_ptr(core::IoError(failure.text));
    case Kind::numerical:
      return std::make_exception_ptr(core::NumericalError(failure.text));
    case Kind::cancelled:
      return std::make_exception_ptr(core::Cancelled(failure.text));
    case Kind::memory:
      return std::make_exception_ptr(std::bad_alloc());
    default:
      return std::make_exception_ptr(std::runtime_error(failure.text));
  }
}

template <class Value>
std::span<std::byte> bytes_of(std::vector<Value>& values) {
  return std::as_writable_bytes(std::span(values));
}

/// Sends every rank the text of one of them.
std::string text_of(Communicator& ranks, int from, std::string text, std::int64_t length) {
  const auto count = static_cast<std::size_t>(ranks.ranks());
  text.resize(static_cast<std::size_t>(length));
  const std::string sent = text;
  std::vector<std::span<const std::byte>> to(count);
  std::vector<std::span<std::byte>> receive(count);
  if (ranks.rank() == from) std::ranges::fill(to, std::as_bytes(std::span(sent)));
  receive[static_cast<std::size_t>(from)] = std::as_writable_bytes(std::span(text));
  ranks.exchange(to, receive);
  return text;
}

}  // namespace

std::vector<std::int64_t> tell_together(Communicator& ranks, const std::function<std::int64_t()>& body) {
  Told mine;
  const Failure failure = caught([&] { mine.value = body(); });
  mine.kind = failure.kind, mine.length = static_cast<std::int64_t>(failure.text.size());
  const auto count = static_cast<std::size_t>(ranks.ranks());
  std::vector<Told> all(count);
  std::vector<std::span<const std::byte>> to(count, std::as_bytes(std::span(&mine, 1)));
  std::vector<std::span<std::byte>> from;
  for (Told& told : all) from.push_back(std::as_writable_bytes(std::span(&told, 1)));
  ranks.exchange(to, from);
  const auto failed = std::ranges::find_if(all, [](const Told& told) { return told.kind != Kind::none; });
  if (failed != all.end()) {
    const auto rank = static_cast<int>(failed - all.begin());
    const std::string text =
        text_of(ranks, rank, rank == ranks.rank() ? failure.text : std::string(), failed->length);
    throw FailedTogether(rank, exception_of({failed->kind, text}));
  }
  std::vector<std::int64_t> values;
  for (const Told& told : all) values.push_back(told.value);
  return values;
}

void together(Communicator& ranks, const std::function<void()>& body) {
  tell_together(ranks, [&]() -> std::int64_t { return body(), 0; });
}

void broadcast(Communicator& ranks, std::span<std::byte> bytes) {
  if (ranks.rank() > 0) return ranks.receive(0, bytes);
  for (int r = 1; r < ranks.ranks(); ++r) ranks.send(r, bytes);
}

std::int64_t broadcast_number(Communicator& ranks, std::int64_t value) {
  broadcast(ranks, std::as_writable_bytes(std::span(&value, 1)));
  return value;
}

void broadcast_matrix(Communicator& ranks, Eigen::MatrixXd& matrix) {
  std::array<std::int64_t, 2> shape{matrix.rows(), matrix.cols()};
  broadcast(ranks, std::as_writable_bytes(std::span(shape)));
  if (ranks.rank() > 0) matrix.resize(shape[0], shape[1]);
  broadcast(ranks, std::as_writable_bytes(std::span(matrix.data(), static_cast<std::size_t>(matrix.size()))));
}

}  // namespace emberfold::dytex
