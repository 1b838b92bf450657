// SPDX-License-Identifier: BSD-2-Clause
#include "worker.hpp"

#include "interrupt.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyn::tool::sweep {

Worker::Worker(const Setting& setting) : setting_(setting), task_(makeTask(setting)), fields_{{"failed", {}, true}, {"success", {}, true}} {
  if (setting.study.keeps("inputs"))
    for (const Quantity& quantity : setting.variation.quantities()) {
      fields_.push_back({"input/" + quantity.name, {quantity.size}});
      inputs_ += static_cast<std::size_t>(quantity.size);
    }
  fields_.insert(fields_.end(), task_->fields().begin(), task_->fields().end());
  constexpr std::size_t most_numbers = std::size_t{1} << 26;
  if (numbersOf(fields_) > most_numbers)
    throw Error(ErrorCode::argument, "the results of one sample take more than 512 MB; keep less, or give a larger 'every'",
                {setting.study.name, 0, ""});
  row_.resize(numbersOf(fields_));
  readSuccess();
}

void Worker::readSuccess() {
  if (!setting_.study.document.contains("success")) return;
  const json::Value success = setting_.study.value()["success"];
  success.eachMember([&](const std::string& name, const json::Value& value) {
    std::size_t first = 0;
    const auto field = std::find_if(fields_.begin(), fields_.end(), [&](const Field& f) {
      if (f.name == name) return true;
      first += f.size();
      return false;
    });
    if (field == fields_.end()) unknownName(success, "kept result", name, namesOf(fields_));
    std::vector<json::Value> ends;
    value.each([&](const json::Value& end) { ends.push_back(end); });
    if (ends.size() != 2) value.fail("must be [low, high]");
    const int size = static_cast<int>(field->size());
    bounds_.push_back({first, readNumbers(ends[0], size), readNumbers(ends[1], size)});
  });
}

void Worker::prepare() {
  try {
    task_->prepare();
  } catch (const std::exception&) {
    if (!Interruption::pending()) throw;
  }
}

std::optional<std::string> Worker::sample(std::int64_t sample, double* row) {
  std::optional<std::string> reason;
  const std::size_t head = 2 + inputs_;
  std::fill(row, row + row_.size(), std::numeric_limits<double>::quiet_NaN());
  prepare();
  try {
    const Inputs inputs = setting_.variation.draw(static_cast<std::uint64_t>(sample));
    std::copy_n(inputs.values.begin(), inputs_, row + 2);
    task_->run(inputs, row + head);
  } catch (const std::exception& e) {
    reason = e.what();
  }
  const double* number = row;
  for (const Field& field : fields_) {
    const double* const end = number + field.size();
    if (number >= row + 2 && !reason && !std::all_of(number, end, [](double x) { return std::isfinite(x); })) reason = field.name + " is not finite";
    number = end;
  }
  row[0] = reason.has_value();
  row[1] = !reason && std::all_of(bounds_.begin(), bounds_.end(), [&](const Bound& bound) {
    for (std::size_t k = 0; k < bound.low.size(); ++k)
      if (!(row[bound.first + k] >= bound.low[k] && row[bound.first + k] <= bound.high[k])) return false;
    return true;
  });
  if (reason) {
    number = row + head;
    std::fill(row + head, row + row_.size(), std::numeric_limits<double>::quiet_NaN());
    double* result = row + head;
    for (const Field& field : task_->fields()) {
      if (field.flag) std::fill_n(result, field.size(), 0.0);  // a byte has no NaN
      result += field.size();
    }
  }
  return reason;
}

std::optional<Chunk> Worker::chunk(std::int64_t first, std::int64_t count) {
  constexpr std::size_t longest_reason = 1000;
  Chunk out{first, count, {}, {}};
  out.numbers.resize(row_.size() * static_cast<std::size_t>(count));
  for (std::int64_t k = 0; k < count; ++k) {
    if (Interruption::pending()) return {};
    if (const std::optional<std::string> reason = sample(first + k, row_.data())) {
      if (Interruption::pending()) return {};  // which can be why it failed
      out.failures.push_back({first + k, reason->substr(0, longest_reason)});
    }
    const double* from = row_.data();
    double* column = out.numbers.data();
    for (const Field& field : fields_) {
      const std::size_t size = field.size();
      std::copy_n(from, size, column + size * static_cast<std::size_t>(k));
      from += size;
      column += size * static_cast<std::size_t>(count);
    }
  }
  return out;
}

}  // namespace dyn::tool::sweep
