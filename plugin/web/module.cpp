// The core for JavaScript, on typed arrays. worker.js calls it; index.d.ts describes what it gives.

#include <emscripten/bind.h>
#include <emscripten/val.h>

#include <cmath>
#include <new>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/contract/error_names.h"
#include "core/contract/filter.h"
#include "core/contract/presets.h"
#include "core/support/errors.h"
#include "core/support/memory.h"
#include "core/support/threads.h"
#include "python/shapes.h"

namespace spectral::web {

namespace {

using emscripten::typed_memory_view;
using emscripten::val;

template <class Scalar>
using Rows = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

bool isMissing(const val& value) { return value.isNull() || value.isUndefined(); }

/// A copy of a typed array, as rows of so many numbers.
template <class Scalar>
Rows<Scalar> rowsOf(const val& array, Index columns) {
    Rows<Scalar> rows(array["length"].as<Index>() / columns, columns);
    const auto size = static_cast<std::size_t>(rows.size());
    val(typed_memory_view(size, rows.data())).call<void>("set", array);
    return rows;
}

/// A copy outside the module's memory, which moves when it grows.
template <class Matrix>
val arrayOf(const Matrix& matrix) {
    const Rows<double> rows = matrix;
    return val(typed_memory_view(static_cast<std::size_t>(rows.size()), rows.data()))
        .call<val>("slice");
}

val jsOf(const Value& value) {
    return std::visit(
        [](const auto& one) {
            if constexpr (std::is_same_v<std::decay_t<decltype(one)>, Eigen::VectorXd>)
                return arrayOf(one);
            else
                return val(one);
        },
        value);
}

template <class Items, class Function>
val listOf(const Items& items, const Function& function) {
    val list = val::array();
    for (const auto& item : items) list.call<void>("push", function(item));
    return list;
}

val textsOf(const std::vector<std::string>& texts) {
    return listOf(texts, [](const std::string& text) { return val(text); });
}

Value valueOf(const std::string& name, const val& given) {
    if (given.isTrue() || given.isFalse()) return given.isTrue();
    if (given.isString()) return given.as<std::string>();
    if (!given.isNumber()) throw InvalidOption(name + ": must be a number, a text, true or false");
    const auto number = given.as<double>();
    const bool isInteger = number == std::floor(number) && std::abs(number) < 0x1p31;
    return isInteger ? Value(static_cast<int>(number)) : Value(number);
}

Values valuesOf(const val& options) {
    Values values;
    const val names = val::global("Object").call<val>("keys", options);
    for (int i = 0; i < names["length"].as<int>(); ++i) {
        const auto name = names[i].as<std::string>();
        values[name] = valueOf(name, options[name]);
    }
    return values;
}

/// @param V, F  vertices and faces of the mesh, kept by the caller.
FilterInput inputOf(const val& mesh, const Rows<double>& V, const Rows<int>& F) {
    FilterInput input{viewOfRows(V.data(), V.rows()), viewOfRows(F.data(), F.rows())};
    if (const val selected = mesh["selected"]; !isMissing(selected)) {
        const Rows<unsigned char> flags = rowsOf<unsigned char>(selected, 1);
        input.selected.assign(flags.data(), flags.data() + flags.size());
    }
    if (const val values = mesh["values"]; !isMissing(values))
        input.values = rowsOf<double>(values, values["length"].as<Index>() / input.V.rows());
    if (const val gain = mesh["gain"]; !isMissing(gain)) input.gain = rowsOf<double>(gain, 2);
    input.words.moreMemory = "filter it in tiles with the Python package";
    return input;
}

val errorOf(const char* text, const char* code, const char* kind, Index limit = 0) {
    val error = val::object();
    error.set("message", std::string(text));
    error.set("code", std::string(code));
    error.set("kind", std::string(kind));
    error.set("limit", static_cast<double>(limit));
    val result = val::object();
    result.set("error", error);
    return result;
}

/// The result of work(), or its error as an object: no exception of C++ leaves the module.
template <class Work>
val guarded(const Work& work) {
    try {
        return work();
    } catch (const Error& error) {
        return errorOf(error.what(), nameOf(error.code()), classOf(error), error.limit());
    } catch (const std::bad_alloc&) {
        return errorOf("no more memory can be had here: simplify the mesh first", "out_of_memory",
                       "MemoryLimitError");
    } catch (const std::exception& error) {
        return errorOf(error.what(), "internal", "Error");
    }
}

const char* nameOf(Parameter::Kind kind) {
    constexpr const char* kNames[] = {"bool", "int", "float", "length", "choice", "str"};
    return kNames[static_cast<int>(kind)];
}

val described(const Parameter& parameter) {
    val made = val::object();
    made.set("name", parameter.name);
    made.set("label", parameter.label);
    made.set("help", parameter.help);
    made.set("unit", parameter.unit);
    made.set("kind", std::string(nameOf(parameter.kind)));
    made.set("default", jsOf(parameter.usual));
    made.set("defaultInWords", parameter.automaticText);
    made.set("isAdvanced", parameter.isAdvanced);
    made.set("low", parameter.low);
    made.set("high", parameter.high > parameter.low ? val(parameter.high) : val::null());
    made.set("isLowOpen", parameter.isLowOpen);
    made.set("choices", textsOf(parameter.choices));
    return made;
}

val presetsOf(const Filter& filter) {
    val list = val::array();
    for (const Preset& preset : allPresets()) {
        if (preset.filter != filter.pythonName) continue;
        val options = val::object(), made = val::object();
        for (const auto& [name, value] : preset.options) options.set(name, jsOf(value));
        made.set("name", preset.name);
        made.set("purpose", preset.purpose);
        made.set("options", options);
        list.call<void>("push", made);
    }
    return list;
}

}  // namespace

/// All filters: names, help, parameters, presets, entries of reports.
val filters() {
    return listOf(allFilters(), [](const Filter& filter) {
        val made = val::object();
        made.set("name", filter.name);
        made.set("pythonName", filter.pythonName);
        made.set("help", filter.help);
        made.set("parameters", listOf(filter.parameters, described));
        made.set("presets", presetsOf(filter));
        made.set("report", listOf(filter.report, [](const ReportEntry& entry) {
                     val one = val::object();
                     one.set("name", entry.name);
                     one.set("meaning", entry.meaning);
                     one.set("isAlways", entry.isAlways);
                     return one;
                 }));
        return made;
    });
}

/// Applies a filter.
///
/// @param mesh      vertices (Float64Array, 3 for each), faces (Int32Array, 3 for each) and, if
/// there
///                  are any, selected (Uint8Array), values (Float64Array, 1 or 3 for each vertex),
///                  gain (Float64Array of pairs): see FilterInput.
/// @param options   values of parameters by name.
/// @param progress  is called with the stage and the fraction done.
/// @return          members of FilterOutput, or {error}.
val applied(const std::string& name, const val& mesh, const val& options, const val& progress) {
    return guarded([&] {
        const Progress listener([&](double fraction, const std::string& stage) {
            progress(stage, fraction);
            return true;
        });
        const Rows<double> V = rowsOf<double>(mesh["vertices"], 3);
        const Rows<int> F = rowsOf<int>(mesh["faces"], 3);
        const FilterOutput output =
            apply(filterNamed(name), inputOf(mesh, V, F), valuesOf(options), listener);
        val made = val::object();
        if (output.V.rows() > 0) made.set("vertices", arrayOf(output.V));
        if (output.details.rows() > 0) made.set("details", arrayOf(output.details));
        if (output.values.rows() > 0) made.set("values", arrayOf(output.values));
        if (output.basis.rows() > 0) made.set("basis", arrayOf(output.basis));
        val report = val::object();
        for (const auto& [entry, value] : output.report) report.set(entry, jsOf(value));
        made.set("report", report);
        made.set("text", output.text);
        made.set("summary", output.summary);
        const auto text = [](const Warning& one) { return val(one.text); };
        const auto code = [](const Warning& one) { return val(kindOf(one.code).name); };
        made.set("warnings", listOf(output.warnings, text));
        made.set("warningCodes", listOf(output.warnings, code));
        return made;
    });
}

/// See followingNormals of the Python package.
/// @param which  Int32Array, 3 for each face.
/// @return       Float64Array, or {error}.
val normals(const val& before, const val& after, const val& faces, const val& given,
            const val& which) {
    return guarded([&] {
        const Rows<double> V = rowsOf<double>(before, 3), X = rowsOf<double>(after, 3);
        const Rows<double> N = rowsOf<double>(given, 3);
        const Rows<std::int64_t> F = rowsOf<int>(faces, 3).cast<std::int64_t>();
        const Rows<std::int64_t> corners = rowsOf<int>(which, 3).cast<std::int64_t>();
        const auto map = [](const auto& rows) {
            using Scalar = typename std::decay_t<decltype(rows)>::Scalar;
            return python::Rows<Scalar>(rows.data(), rows.rows(), rows.cols());
        };
        return arrayOf(python::followingNormals(map(V), map(X), map(F), map(N), map(corners)));
    });
}

}  // namespace spectral::web

EMSCRIPTEN_BINDINGS(spectral) {
    emscripten::function("filters", spectral::web::filters);
    emscripten::function("apply", spectral::web::applied);
    emscripten::function("followingNormals", spectral::web::normals);
    emscripten::function("setMemoryLimit", spectral::setMemoryLimit);
    emscripten::function("setThreadCount", spectral::setThreadCount);
}
