# SPDX-License-Identifier: BSD-2-Clause
"""libdyn/doc/python_api.md says of every public C++ function what it is in Python, or why it is not there.

`tools/python tests/python/api_test.py --write` adds rows for new functions, removes those of functions that are gone, and fills in Python names that
follow from the C++ ones. Reasons are written by hand.
"""
import pathlib
import re
import sys
import unittest

import libdyn as dyn

SOURCE = pathlib.Path(__file__).parents[2]
HEADERS = (SOURCE / "libdyn" / "include", SOURCE / "parsers" / "include")
TABLE = SOURCE / "libdyn" / "doc" / "python_api.md"
WORDS = {"if", "for", "while", "switch", "return", "sizeof", "alignas", "requires", "static_assert", "decltype", "noexcept", "void", "int", "bool",
         "double", "float", "__attribute__", "visibility", "explicit", "const", "Approach"}


def without_comments(text):
    text = re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.DOTALL)
    text = re.sub(r'"(?:\\.|[^"\\\n])*"', '""', text)
    return re.sub(r"^\s*#(?:[^\n]*\\\n)*[^\n]*", "", text, flags=re.MULTILINE)


def without_template(text):
    """Removes template<...> and requires-clauses in front of a declaration."""
    text = text.strip()
    while text.startswith("template"):
        depth, end = 0, text.index("<")
        for end in range(end, len(text)):
            depth += {"<": 1, ">": -1}.get(text[end], 0)
            if depth == 0:
                break
        text = text[end + 1:].strip()
        if text.startswith("requires"):
            depth = 0
            for end, c in enumerate(text):
                depth += {"<": 1, ">": -1, "(": 1, ")": -1}.get(c, 0)
                if depth == 0 and c == ">" or (depth == 0 and c == "\n"):
                    break
            text = text[end + 1:].strip()
    return text


def functions_of(text):
    """Returns the names of public functions of a header, such as compile, cholesky::solve and Simulator::advance."""
    found, scopes, statement = [], [], ""

    def declared():
        """Records the function that the statement declares, if it is one that users call."""
        declaration = without_template(statement)
        if any(kind == "block" or name in ("detail", "") or access != "public" for kind, name, access in scopes):
            return
        if re.match(r"(using|friend|enum|typedef|struct|class|static_assert|extern)\b", declaration):
            return
        match = re.search(r"(?<![\w:~.>])(operator\s*\W+?|\w+)\s*\(", declaration)
        if match is None or match[1] in WORDS or match[1].startswith("operator") or "~" in declaration[:match.start() + 1]:
            return
        if "=" in declaration[:match.start()] or re.search(r"function<[^;]*$", declaration[:match.start()]):
            return
        path = [name for _, name, _ in scopes if name != "dyn"]
        if match[1] not in path and match[1] != "impl":  # no constructors, and nothing internal
            found.append("::".join([*path, match[1]]))

    for c in re.sub(r"\b(public|private|protected):", r"\1;", without_comments(text)):
        if c == "{":
            head = without_template(statement)
            namespace = re.match(r"(?:inline )?namespace\s*([\w:]*)$", head)
            record = re.match(r"(class|struct)\s+(?:DYN_API\s+)?(\w+)", head)
            if namespace:
                scopes += [("namespace", name, "public") for name in namespace[1].split("::")][:1]
                scopes[-1] = ("namespace", namespace[1].removeprefix("dyn::") if namespace[1] != "dyn" else "dyn", "public")
            elif record and "(" not in head.split(":")[0]:
                scopes.append(("class", record[2], "private" if record[1] == "class" else "public"))
            else:
                declared()
                scopes.append(("block", "", "public"))
            statement = ""
        elif c == "}":
            if scopes:
                scopes.pop()
            statement = ""
        elif c == ";":
            label = statement.strip()
            if label in ("public", "private", "protected") and scopes:
                scopes[-1] = (*scopes[-1][:2], label)
            else:
                declared()
            statement = ""
        else:
            statement += c
    return list(dict.fromkeys(found))


def headers():
    """Returns the functions of every header, by the header's name."""
    out = {}
    for folder in HEADERS:
        for path in sorted(folder.rglob("*.hpp")):
            out[str(path.relative_to(folder))] = functions_of(path.read_text())
    return out


def python_style(name):
    words = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower()
    return words


def guess(name):
    """Returns the Python name that follows from a C++ name, in backquotes, if there is such a thing; else nothing."""
    *path, last = name.split("::")
    for candidate in (".".join([*path, python_style(last)]), ".".join([*path, last])):
        if exists(candidate):
            return f"`{candidate}`"
    return ""


def exists(name):
    thing = dyn
    for part in re.sub(r"\(.*", "", name).split("."):
        if not hasattr(thing, part):
            return False
        thing = getattr(thing, part)
    return True


def read_table(text):
    """Returns the reasons of headers without rows, and the Python column of all rows, by header and C++ name."""
    left_out, rows, header = {}, {}, None
    for line in text.splitlines():
        if line.startswith("## "):
            header = line[3:].strip("` ")
        cells = [cell.strip() for cell in line.strip("|").split("|")] if line.startswith("| `") else []
        if len(cells) == 2 and header == "Headers for C++ only":
            left_out[cells[0].strip("`")] = cells[1]
        elif len(cells) == 2:
            rows[header, cells[0].strip("`")] = cells[1]
    return left_out, rows


def written_table(text):
    """Returns the document with a row for every function."""
    left_out, rows = read_table(text)
    marker = "## `"
    out = [text[: text.index("\n" + marker)].rstrip() if "\n" + marker in text else text.rstrip(), ""]
    for header, functions in headers().items():
        if header in left_out or not functions:
            continue
        out += [f"## `{header}`", "", "| C++ | Python |", "|---|---|"]
        out += [f"| `{name}` | {rows.get((header, name)) or guess(name)} |" for name in functions]
        out.append("")
    return "\n".join(out)


class Table(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        self.left_out, self.rows = read_table(TABLE.read_text())
        self.headers = headers()

    def test_every_public_function_has_a_row(self):
        wanted = {(header, name) for header, names in self.headers.items() if header not in self.left_out for name in names}
        self.assertEqual(sorted(wanted - set(self.rows)), [], "run tools/python tests/python/api_test.py --write")
        self.assertEqual(sorted(set(self.rows) - wanted), [], "these functions are gone")
        self.assertEqual(sorted(set(self.left_out) - set(self.headers)), [], "these headers are gone")
        self.assertGreater(len(wanted), 250)

    def test_every_python_name_exists_and_nothing_is_missing_without_a_reason(self):
        for place, python in self.rows.items():
            names = re.findall(r"`([^`]+)`", python)
            if python.startswith("`"):
                self.assertEqual([name for name in names if not exists(name)], [], place)
            else:
                self.assertGreater(len(python.split()), 2, f"{place}: no Python name and no reason")
        for header, reason in self.left_out.items():
            self.assertGreater(len(reason.split()), 2, header)

    def test_the_reader_finds_functions_and_nothing_else(self):
        text = """
namespace dyn {
struct Box { int width = 0; int area() const { return compute(width); } std::function<void(int)> called; };
class DYN_API Door { public: Door(int); ~Door(); void open(double angle) const; private: void hidden(); };
namespace detail { DYN_API void inner(int); }
/// A comment(with) brackets.
template <class T> DYN_API Motion<T> moved(const T& x, int k = f(3));
inline int half(int x) { return x / two(x); }
using Call = void (*)(int);
inline constexpr int most = least(3);
}
namespace dyn::tree { template <detail::Writable T> void solve(T&& x) { (void)x; } }
"""
        self.assertEqual(functions_of(text), ["Box::area", "Door::open", "moved", "half", "tree::solve"])
        self.assertEqual(python_style("computeRNEASecondOrderDerivatives"), "compute_rnea_second_order_derivatives")


if __name__ == "__main__":
    if "--write" in sys.argv:
        TABLE.write_text(written_table(TABLE.read_text()))
    else:
        unittest.main()
