// SPDX-License-Identifier: BSD-2-Clause
#include "codegen/compiler.hpp"
#include "joint/loader.hpp"

#include <dyn/codegen/native.hpp>
#include <dyn/error.hpp>

namespace dyn {

struct CompiledFunction::Impl {
  std::string name;
  std::vector<ArgumentShape> inputs, outputs;
  bool cached = false;
  bool plain = true;  ///< one state, in double
  void (*code)(const void* const* in, void* const* out) = nullptr;
};

namespace {

/// C source of dyn_call(), which takes any number of arguments as two arrays of pointers.
std::string uniformEntry(const TracedFunction& f) {
  std::string out = "__attribute__((visibility(\"default\"))) void dyn_call(const void* const* in, void* const* out) {\n  " + f.name + "(";
  for (std::size_t i = 0; i < f.inputs.size(); ++i) out += "(const dyn_real*)in[" + std::to_string(i) + "], ";
  for (std::size_t i = 0; i < f.outputs.size(); ++i) out += "(dyn_real*)out[" + std::to_string(i) + "], ";
  out.resize(out.size() - 2);
  return out + ");\n}\n";
}

CompiledFunction make(const TracedFunction& f, const ObjectCache& cache, const NativeOptions& options) {
  const std::size_t operations = static_cast<std::size_t>(f.graph.count().total());
  if (operations > options.operations)
    throw Error(ErrorCode::compiler, "'" + f.name + "' has " + std::to_string(operations) + " operations, more than the " +
                                         std::to_string(options.operations) + " that may be compiled (NativeOptions::operations)");
  SourceOptions how;
  how.single_precision = options.single_precision;
  how.lanes = options.lanes;
  CompilerTask task{.what = "'" + f.name + "'",
                    .size = " (" + std::to_string(operations) + " operations)",
                    .source = writeSource({f}, how).code() + uniformEntry(f),
                    .file = "code.c",
                    .words = compilerCommand(options.compiler, "CC", "cc"),
                    .flags = {"-std=gnu99", "-shared", "-fPIC", "-fvisibility=hidden", "-ffp-contract=fast", "-fno-math-errno", "-fno-trapping-math",
                              "-fno-tree-vectorize"},
                    .seconds = options.seconds,
                    .remedy = "allow more (NativeOptions::seconds), or compile with -O1"};
  task.flags.insert(task.flags.end(), options.flags.begin(), options.flags.end());
  const std::string entry = entryName(task);

  auto impl = std::make_shared<CompiledFunction::Impl>();
  impl->name = f.name;
  impl->inputs = f.inputs;
  impl->outputs = f.outputs;
  impl->plain = options.lanes == 1 && !options.single_precision;
  const std::optional<OpenFile> found = cache.find(entry);
  void* symbol = found ? openFunction(*found, "dyn_call") : nullptr;
  impl->cached = symbol != nullptr;
  if (symbol == nullptr) {
    if (options.progress) options.progress("compiling " + f.name + ", " + std::to_string(operations) + " operations");
    const OpenFile object = compileInto(cache, entry, task);
    symbol = openFunction(object, "dyn_call");
    if (symbol == nullptr) throw Error(ErrorCode::compiler, "'" + f.name + "' was compiled but cannot be loaded", {object.path(), 0, ""});
  }
  impl->code = reinterpret_cast<void (*)(const void* const*, void* const*)>(symbol);
  return CompiledFunction(std::move(impl));
}

}  // namespace

CompiledFunction::CompiledFunction(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
const std::string& CompiledFunction::name() const { return impl_->name; }
const std::vector<ArgumentShape>& CompiledFunction::inputs() const { return impl_->inputs; }
const std::vector<ArgumentShape>& CompiledFunction::outputs() const { return impl_->outputs; }
bool CompiledFunction::cached() const { return impl_->cached; }
void CompiledFunction::call(const void* const* in, void* const* out) const { impl_->code(in, out); }

void CompiledFunction::operator()(std::initializer_list<VectorArg> in, std::initializer_list<VectorOut> out) const {
  constexpr std::size_t most = 8;
  if (!impl_->plain) throw Error(ErrorCode::argument, "'" + impl_->name + "' is of several states or in float: use call()");
  if (in.size() != impl_->inputs.size() || out.size() != impl_->outputs.size() || in.size() > most || out.size() > most)
    throw Error(ErrorCode::size, "'" + impl_->name + "' takes " + std::to_string(impl_->inputs.size()) + " arguments and has " +
                                     std::to_string(impl_->outputs.size()) + " results; it was given " + std::to_string(in.size()) + " and " +
                                     std::to_string(out.size()));
  const void* from[most];
  void* to[most];
  const auto check = [&](const ArgumentShape& shape, const double* data, std::ptrdiff_t size) {
    if (data == nullptr && size > 0) throw Error(ErrorCode::argument, "'" + impl_->name + "': " + shape.name + " is a null pointer");
    if (size != shape.size())
      throw Error(ErrorCode::size,
                  "'" + impl_->name + "': " + shape.name + " has " + std::to_string(size) + " numbers, it needs " + std::to_string(shape.size()));
  };
  std::size_t i = 0;
  for (const VectorArg& a : in) {
    const VectorView view = a;
    check(impl_->inputs[i], view.data, view.size);
    from[i++] = view.data;
  }
  i = 0;
  for (const VectorOut& a : out) {
    check(impl_->outputs[i], a.data(), a.size());
    to[i++] = a.data();
  }
  impl_->code(from, to);
}

CompiledModel::CompiledModel(std::vector<CompiledFunction> functions) : functions_(std::move(functions)) {}

const CompiledFunction& CompiledModel::function(const std::string& name) const {
  for (const CompiledFunction& f : functions_)
    if (f.name() == name) return f;
  throw Error(ErrorCode::argument, "there is no compiled function '" + name + "'");
}

CompiledModel compileNative(const std::vector<TracedFunction>& functions, const NativeOptions& options) {
  const ObjectCache cache(options.cache);
  std::vector<CompiledFunction> out;
  out.reserve(functions.size());
  for (const TracedFunction& f : functions) out.push_back(make(f, cache, options));
  return CompiledModel(std::move(out));
}

CompiledModel compileNative(const CompactModel& model, const std::vector<std::string>& functions, const NativeOptions& options) {
  std::vector<TracedFunction> traced;
  traced.reserve(functions.size());
  for (const std::string& f : functions) {
    if (options.progress) options.progress("tracing " + f);
    traced.push_back(trace(model, f, {.packable = options.lanes == 1}));
  }
  return compileNative(traced, options);
}

}  // namespace dyn
