// SPDX-License-Identifier: BSD-2-Clause
// Algorithms as expression graphs: tracing, evaluation and derivatives.
#include "choices.hpp"
#include "evaluation.hpp"
#include "typed.hpp"

#include <dyn/codegen/casadi.hpp>
#include <dyn/codegen/differentiate.hpp>

#include <pybind11/stl.h>

namespace dyn::python {

namespace {

const char* nameOf(Operation operation) {
  static constexpr const char* names[] = {"input", "constant", "add", "subtract", "multiply", "divide", "negate", "sqrt",
                                          "sin",   "cos",      "tan", "exp",      "log",      "atan2",  "abs",    "select_less"};
  return names[static_cast<int>(operation)];
}

/// Runs a graph whose inputs and outputs are split into arguments.
void run(const Graph& graph, const std::vector<ArgumentShape>& inputs, const std::vector<ArgumentShape>& outputs, Evaluation<double>& evaluation) {
  std::vector<double> numbers(static_cast<std::size_t>(graph.inputs)), values(graph.nodes.size());
  evaluation.run(1, [&](const void* const* in, void* const* out) {
    double* to = numbers.data();
    for (std::size_t k = 0; k < inputs.size(); ++k) to = std::copy_n(static_cast<const double*>(in[k]), inputs[k].size(), to);
    replayNodes(graph, numbers.data(), values.data());
    const std::uint32_t* from = graph.outputs.data();
    for (std::size_t k = 0; k < outputs.size(); ++k)
      for (int i = 0; i < outputs[k].size(); ++i) static_cast<double*>(out[k])[i] = values[*from++];
  });
}

py::object evaluatedGraph(const Graph& graph, const py::args& arguments) {
  const std::vector<ArgumentShape> inputs = {{"x", graph.inputs}}, outputs = {{"y", static_cast<int>(graph.outputs.size())}};
  Evaluation<double> evaluation("the graph", inputs, outputs, arguments);
  run(graph, inputs, outputs, evaluation);
  return evaluation.results();
}

/// Returns all blocks as dense matrices, by the names of output and input.
using Matrices = Typed<py::dict, "dict[tuple[str, str], NDArray[float64]]">;

Matrices evaluatedBlocks(const JacobianBlocks& x, const std::vector<ArgumentShape>& outputs, const py::args& arguments) {
  const TracedFunction& f = x.function;
  Evaluation<double> evaluation(f.name, f.inputs, f.outputs, arguments);
  run(f.graph, f.inputs, f.outputs, evaluation);
  py::dict out;
  for (std::size_t k = 0; k < x.blocks.size(); ++k) {
    const Sparsity& places = x.blocks[k];
    py::array_t<double> dense({evaluation.states(), py::ssize_t{places.rows}, py::ssize_t{places.columns}});
    std::fill_n(dense.mutable_data(), dense.size(), 0.0);
    for (py::ssize_t state = 0; state < evaluation.states(); ++state)
      for (std::size_t i = 0; i < places.row.size(); ++i) dense.mutable_at(state, places.row[i], places.column[i]) = evaluation.output(k, state)[i];
    const py::tuple names = py::make_tuple(outputs[k / f.inputs.size()].name, f.inputs[k % f.inputs.size()].name);
    out[names] = evaluation.batch() ? py::object(dense) : py::object(dense[py::int_(0)]);
  }
  return out;
}

/// Blocks of a Jacobian, and the outputs of the function that was differentiated.
struct Blocks {
  JacobianBlocks blocks;
  std::vector<ArgumentShape> outputs;
};

Mode modeOf(const std::string& name) { return chosen<Mode>("mode", name, {{"forward", Mode::forward}, {"reverse", Mode::reverse}}); }

std::string writtenShape(const ArgumentShape& s) {
  return s.name + " (" + std::to_string(s.rows) + (s.columns == 1 ? ",)" : ", " + std::to_string(s.columns) + ")");
}

void addGraphClass(py::module_& m) {
  py::class_<OperationCounts>(m, "OperationCounts", "The number of operations of each kind in one evaluation.")
      .def_readonly("additions", &OperationCounts::additions, "Subtractions, negations and absolute values are included.")
      .def_readonly("multiplications", &OperationCounts::multiplications, "Products.")
      .def_readonly("divisions", &OperationCounts::divisions, "Square roots are included.")
      .def_readonly("functions", &OperationCounts::functions, "Sine and cosine of one angle count as one each.")
      .def_readonly("selections", &OperationCounts::selections, "Operations a < b ? c : d.")
      .def_property_readonly("total", &OperationCounts::total, "The sum of all.");
  py::class_<GraphNode>(m, "GraphNode", "One operation of a graph.")
      .def_property_readonly(
          "operation", [](const GraphNode& n) { return nameOf(n.operation); }, "Its name: 'add', 'sin', 'input', 'constant' and so on.")
      .def_property_readonly(
          "arguments",
          [](const GraphNode& n) {
            return std::vector<std::uint32_t>(n.argument, n.argument + (n.operation == Operation::input ? 1 : arity(n.operation)));
          },
          "Indices of earlier nodes; for an input its number.")
      .def_readonly("value", &GraphNode::value, "The value of a constant.");
  py::class_<Graph>(m, "Graph", "A function as a list of operations. Call it with a vector (inputs,), or with a state a row.")
      .def_readonly("inputs", &Graph::inputs, "The number of inputs.")
      .def_property_readonly(
          "outputs", [](const Graph& g) { return g.outputs.size(); }, "The number of outputs.")
      .def_readonly("nodes", &Graph::nodes, "All operations, inputs and constants, in an order of evaluation.")
      .def_readonly("output_nodes", &Graph::outputs, "The index of the node of each output.")
      .def("count", &Graph::count, "Counts the operations of one evaluation.")
      .def("__call__", &evaluatedGraph, "Returns the outputs (outputs,), or (states, outputs).")
      .def("__repr__", [](const Graph& g) {
        return "<libdyn.Graph: " + std::to_string(g.inputs) + " inputs, " + std::to_string(g.outputs.size()) + " outputs, " +
               std::to_string(g.count().total()) + " operations>";
      });
  py::class_<Sparsity>(m, "Sparsity", "The entries of a Jacobian that can be nonzero.")
      .def_readonly("rows", &Sparsity::rows, "The number of rows of the matrix.")
      .def_readonly("columns", &Sparsity::columns, "The number of columns of the matrix.")
      .def_readonly("row", &Sparsity::row, "The row of each entry.")
      .def_readonly("column", &Sparsity::column, "The column of each entry.");
  py::class_<JacobianGraph>(m, "JacobianGraph", "The Jacobian of a graph, as a graph.")
      .def_readonly("graph", &JacobianGraph::graph, "It has the same inputs as the function; its outputs are the entries.")
      .def_readonly("sparsity", &JacobianGraph::sparsity, "The places of the entries, row after row.");
}

void addTracing(py::module_& m) {
  py::class_<ArgumentShape>(m, "ArgumentShape", "Name and shape of an argument: a vector, or a matrix that is stored column after column.")
      .def(py::init([](const std::string& name, int rows, int columns) {
             return ArgumentShape{name, rows, columns};
           }),
           py::arg("name"), py::arg("rows"), py::arg("columns") = 1)
      .def_readonly("name", &ArgumentShape::name, "The symbol, such as q.")
      .def_readonly("rows", &ArgumentShape::rows, "The length of a vector.")
      .def_readonly("columns", &ArgumentShape::columns, "1 for a vector.")
      .def("__repr__", [](const ArgumentShape& s) { return "<" + writtenShape(s) + ">"; });
  py::class_<TracedFunction>(
      m, "TracedFunction",
      "A graph whose inputs and outputs are split into arguments. Call it with a vector for each input, or with a state a row; it\n"
      "runs operation by operation (compile_native() makes it fast).")
      .def(py::init(
               [](const std::string& name, const Graph& graph, const std::vector<ArgumentShape>& inputs, const std::vector<ArgumentShape>& outputs) {
                 const auto check = [](const char* what, const std::vector<ArgumentShape>& shapes, std::size_t wanted) {
                   std::size_t size = 0;
                   for (const ArgumentShape& s : shapes) {
                     if (s.rows < 0 || s.columns < 0) throw Error(ErrorCode::size, "TracedFunction: '" + s.name + "' has a negative size");
                     size += static_cast<std::size_t>(s.size());
                   }
                   if (size != wanted)
                     throw Error(ErrorCode::size, std::string("TracedFunction: the ") + what + " have " + std::to_string(size) +
                                                      " numbers, and the graph has " + std::to_string(wanted));
                 };
                 check("inputs", inputs, static_cast<std::size_t>(graph.inputs));
                 check("outputs", outputs, graph.outputs.size());
                 return TracedFunction{name, graph, inputs, outputs};
               }),
           py::arg("name"), py::arg("graph"), py::arg("inputs"), py::arg("outputs"))
      .def_readonly("name", &TracedFunction::name, "The symbol, such as q.")
      .def_readonly("graph", &TracedFunction::graph, "Inputs and outputs argument after argument.")
      .def_readonly("inputs", &TracedFunction::inputs, "The shapes of the inputs.")
      .def_readonly("outputs", &TracedFunction::outputs, "The shapes of the outputs.")
      .def("__call__", &evaluated, "Returns the output, or a tuple of all outputs; they have one more dimension, the state, for rows of states.")
      .def("__repr__", [](const TracedFunction& f) {
        std::string in, out;
        for (const ArgumentShape& s : f.inputs) in += (in.empty() ? "" : ", ") + writtenShape(s);
        for (const ArgumentShape& s : f.outputs) out += (out.empty() ? "" : ", ") + writtenShape(s);
        return "<libdyn.TracedFunction " + f.name + ": " + in + " -> " + out + ">";
      });
  m.def("traceable_functions", &traceableFunctions, "Returns the names that trace() accepts.");
  m.def(
      "trace", [](const CompactModel& model, const std::string& function, bool packable) { return trace(model, function, {packable}); },
      py::arg("model"), py::arg("function"), py::kw_only(), py::arg("packable") = false, py::call_guard<py::gil_scoped_release>(),
      "Runs an algorithm on unknown values; returns what it computes as a TracedFunction.\n\n"
      "function: a name of traceable_functions(). Poses have 12 numbers a column: the rotation row after row, then the position. packable: marks\n"
      "operations that source of one state per call can compute side by side.");
}

}  // namespace

py::object evaluated(const TracedFunction& f, const py::args& arguments) {
  Evaluation<double> evaluation(f.name, f.inputs, f.outputs, arguments);
  run(f.graph, f.inputs, f.outputs, evaluation);
  return evaluation.results();
}

void addGraphs(py::module_& m) {
  addGraphClass(m);
  addTracing(m);
  const py::arg graph("graph");
  const py::call_guard<py::gil_scoped_release> unlocked;
  m.def(
      "differentiate", [](const Graph& g, const std::string& mode) { return differentiate(g, modeOf(mode)); }, graph, py::arg("mode") = "forward",
      unlocked, "Returns the JacobianGraph of d outputs / d inputs. mode: 'forward' suits few inputs, 'reverse' few outputs.");
  m.def("gradient", &gradient, graph, unlocked,
        "Returns the graph of d(weights . outputs) / d inputs. Its inputs are those of the graph, then one weight for each output.");
  m.def("directional", &directional, graph, unlocked,
        "Returns the graph of the outputs' change along a direction. Its inputs are those of the graph, then their direction.");
  py::class_<Blocks>(m, "JacobianBlocks", "The blocks d(output)/d(input) of a function's Jacobian. Call it with the function's arguments.")
      .def_property_readonly(
          "function", [](const Blocks& x) { return x.blocks.function; },
          "The TracedFunction jac_NAME; its output jac_OUT_IN has the entries of one block, column after column.")
      .def_property_readonly(
          "blocks", [](const Blocks& x) { return x.blocks.blocks; }, "The Sparsity of each block, output by output, input by input.")
      .def(
          "__call__", [](const Blocks& x, const py::args& arguments) { return evaluatedBlocks(x.blocks, x.outputs, arguments); },
          "Returns dense matrices by (output, input): their names. Rows of states give one more dimension.");
  m.def(
      "jacobian_blocks",
      [](const TracedFunction& f) {
        return Blocks{jacobianBlocks(f), f.outputs};
      },
      py::arg("function"),
      "Returns the blocks of a traced function's Jacobian, by forward mode. The derivative by q is that by its coordinates, not in the tangent "
      "space.");
}

}  // namespace dyn::python
