#include "meshlab/dialog.h"

#include <common/parameters/rich_parameters.h>

#include <QRegularExpression>
#include <QTimer>
#include <algorithm>

#include "core/contract/equalizer.h"
#include "core/contract/presets.h"
#include "core/mesh/measures.h"
#include "meshlab/host_workarounds/apply_anew.h"
#include "meshlab/host_workarounds/closed_preview.h"
#include "meshlab/host_workarounds/filter_dialog.h"
#include "meshlab/host_workarounds/fit_screen.h"
#include "meshlab/host_workarounds/number_fields.h"
#include "meshlab/host_workarounds/octave_sliders.h"
#include "meshlab/host_workarounds/preset_box.h"
#include "meshlab/host_workarounds/share_slider.h"
#include "meshlab/mesh_conversion.h"

namespace {

using spectral::Parameter;
using Kind = Parameter::Kind;

/// Parameters of this host alone: others write files, and compare them.
const char* const kColorByDisplacement = "color_by_displacement";
const char* const kKeepOriginal = "keep_original";
const char* const kKeepOriginalLabel = "Keep the original";

/// The number of the equalizer's slider that a parameter is; none if it is not one.
std::size_t sliderOf(const spectral::Filter& filter, const Parameter& parameter) {
    const auto i = static_cast<std::size_t>(&parameter - filter.parameters.data());
    const bool isSlider = filter.pythonName == "apply_coord_spectral_equalizer" &&
                          i < spectral::kEqualizerTimes.size();
    return isSlider ? i : spectral::kEqualizerTimes.size();
}

bool isSlider(const spectral::Filter& filter, const Parameter& parameter) {
    return sliderOf(filter, parameter) < spectral::kEqualizerTimes.size();
}

QString sliderLabel(const spectral::Filter& filter, const Parameter& parameter,
                    const spectral::MeshLengths& mesh) {
    // The reference documentation is generated without a mesh: there are no sizes.
    if (!(mesh.meanEdge > 0.0)) return QString::fromStdString(parameter.label);
    return QString::fromStdString(spectral::equalizerLabel(
        sliderOf(filter, parameter),
        spectral::defaultSmallestSize(mesh.meanEdge, mesh.surfaceDiagonal), mesh.diagonal));
}

/// The length that most people choose tells how long an edge is.
QString lengthLabel(const Parameter& parameter, const spectral::MeshLengths& mesh) {
    const QString label = QString::fromStdString(parameter.label);
    if (parameter.isAdvanced || !(mesh.meanEdge > 0.0)) return label;
    return label + QString("; edge %1").arg(mesh.meanEdge, 0, 'g', 2);
}

QString tooltipOf(const Parameter& parameter, const spectral::MeshLengths& mesh) {
    // MeshLab's fields take no unit: 0.2e is for scripts.
    static const QRegularExpression inEdges("\\b([0-9][0-9.]*)e\\b");
    QString html = asHtml(parameter.help).replace(inEdges, "\\1 mean edges");
    if (parameter.kind != Kind::Length) return html;
    html += QString(" Default: %1.").arg(QString::fromStdString(parameter.automaticText));
    if (mesh.meanEdge > 0.0)
        html += QString(" The mean edge length of this mesh is %1.").arg(mesh.meanEdge, 0, 'g', 3);
    return html;
}

/// @param vertices       of the mesh; 0: the reference documentation is generated without one.
/// @param isAnySelected  whether any face is.
void add(const spectral::Filter& filter, const Parameter& one, const spectral::MeshLengths& mesh,
         int vertices, bool isAnySelected, RichParameterList& list) {
    const QString name = QString::fromStdString(one.name), help = tooltipOf(one, mesh);
    const QString label = QString::fromStdString(one.label);
    switch (one.kind) {
        case Kind::Bool:
            // As in MeshLab's own filters.
            if (one.name == "selected")
                list.addParam(RichBool(name, isAnySelected, label, help, !isAnySelected));
            else
                list.addParam(
                    RichBool(name, std::get<bool>(one.usual), label, help, one.isAdvanced));
            break;
        case Kind::Integer: {
            int usual = std::get<int>(one.usual);
            // A mesh of fewer vertices has no such basis.
            if (one.name == "basis_size" && !one.isAdvanced && vertices > 1)
                usual = std::min(usual, vertices - 1);
            list.addParam(RichInt(name, usual, label, help, one.isAdvanced));
            break;
        }
        case Kind::Number: {
            const auto usual = static_cast<Scalarm>(std::get<double>(one.usual));
            if (!isSlider(filter, one)) {
                list.addParam(RichFloat(name, usual, label, help, one.isAdvanced));
                break;
            }
            list.addParam(RichDynamicFloat(name, usual, static_cast<Scalarm>(one.low),
                                           static_cast<Scalarm>(one.high),
                                           sliderLabel(filter, one, mesh), help));
            break;
        }
        case Kind::Length: {
            const auto usual = static_cast<Scalarm>(spectral::automaticLength(one, mesh));
            list.addParam(RichPercentage(name, usual, 0, static_cast<Scalarm>(mesh.diagonal),
                                         lengthLabel(one, mesh), help, one.isAdvanced));
            break;
        }
        case Kind::Choice: {
            QStringList choices;
            for (const std::string& choice : one.choices)
                choices.push_back(QString::fromStdString(choice));
            list.addParam(
                RichEnum(name, std::get<int>(one.usual), choices, label, help, one.isAdvanced));
            break;
        }
        case Kind::Text:
            list.addParam(RichString(name, QString::fromStdString(std::get<std::string>(one.usual)),
                                     label, help, one.isAdvanced));
            break;
    }
}

/// What fields of a dialog hold: length units, numbers of choices, texts.
QVariant fieldValue(const Parameter& parameter, const spectral::Value& given,
                    const spectral::MeshLengths& mesh) {
    const spectral::Value value = spectral::converted(parameter, given, mesh);
    if (const auto* text = std::get_if<std::string>(&value)) return QString::fromStdString(*text);
    if (const auto* number = std::get_if<double>(&value)) return *number;
    if (const auto* integer = std::get_if<int>(&value)) return *integer;
    return std::get<bool>(value);
}

/// Lets the user start from the presets of a filter, if there are any.
/// @param labels  of the parameters' fields.
void offerPresets(const spectral::Filter& filter, const spectral::MeshLengths& mesh,
                  const QStringList& labels) {
    std::vector<FieldValues> boxes;
    const auto offer = [&](const QString& name, const spectral::Values& options) {
        boxes.push_back({name, {}});
        for (const Parameter& one : filter.parameters) {
            const auto found = options.find(one.name);
            boxes.back().values.push_back(
                fieldValue(one, found != options.end() ? found->second : one.usual, mesh));
        }
    };
    offer("defaults", {});
    for (const spectral::Preset& preset : spectral::allPresets())
        if (preset.filter == filter.pythonName)
            offer(QString::fromStdString(preset.name + ": " + preset.purpose), preset.options);
    if (boxes.size() > 1) addPresetBox(labels, boxes);
}

}  // namespace

QString asHtml(const std::string& text) {
    QString html;
    bool isBold = false, isName = false;
    for (const QChar c : QString::fromStdString(text).toHtmlEscaped()) {
        if (c == '*')
            html += (isBold = !isBold) ? "<b>" : "</b>";
        else if (c == '|')
            isName = !isName;
        else
            html += isName && c == '_' ? QChar(' ') : c;
    }
    static const QRegularExpression link("\\[([^]]*)\\]\\((https://[^)]*)\\)");
    return html.replace(link, "<a href=\"\\2\">\\1</a>");
}

QString helpOf(const spectral::Filter& filter) {
    const QString help = asHtml(filter.help);
    if (filter.source.empty()) return help;
    return help + " <small>" + asHtml(filter.source) + "</small>";
}

RichParameterList parametersOf(const spectral::Filter& filter, const MeshModel& mesh,
                               const spectral::MeshLengths& lengths, bool movesVertices) {
    RichParameterList list;
    // Not MeshLab's own bounding box, which stays that of a preview that was switched off.
    for (const Parameter& one : filter.parameters)
        add(filter, one, lengths, mesh.cm.vn, hasSelectedFaces(mesh.cm), list);
    if (!movesVertices) return list;
    list.addParam(
        RichBool(kColorByDisplacement, false, "Colour by displacement",
                 "Colour every vertex by how far it moves along its normal: <b>red</b> outwards, "
                 "<b>blue</b> inwards, white not at all. The log has the scale and the largest "
                 "values. Colours from before become the vertex attribute color_before."));
    list.addParam(
        RichBool(kKeepOriginal, false, kKeepOriginalLabel,
                 "Keep the mesh as it is now in a hidden layer of its own, as MeshLab cannot undo "
                 "a filter."));
    return list;
}

bool isOriginalKept(const RichParameterList& parameters) {
    return parameters.hasParameter(kKeepOriginal) && parameters.getBool(kKeepOriginal);
}

bool isColoredByDisplacement(const RichParameterList& parameters) {
    return parameters.hasParameter(kColorByDisplacement) &&
           parameters.getBool(kColorByDisplacement);
}

void recordOriginalKept(MeshDocument& document) {
    FilterScript& history = document.filterHistory;
    QTimer::singleShot(0, &document, [&history, before = history.size()] {
        if (history.size() == before + 1)
            history.last().second.setValue(kKeepOriginal, BoolValue(true));
    });
}

void adaptDialog(const spectral::Filter& filter, const spectral::MeshLengths& mesh) {
    if (!hasWindows()) return;
    checkNumberFields(numberLabels(filter).all);
    QString accurate, size;
    QStringList sliders, labels;
    for (const Parameter& one : filter.parameters) {
        if (one.name == filter.accurate) accurate = QString::fromStdString(one.label);
        if (one.name == "power") addShareSlider(QString::fromStdString(one.label));
        if (one.kind == Kind::Length) size = lengthLabel(one, mesh);
        if (isSlider(filter, one)) sliders.push_back(sliderLabel(filter, one, mesh));
        labels.push_back(isSlider(filter, one)      ? sliders.back()
                         : one.kind == Kind::Length ? lengthLabel(one, mesh)
                         : one.name == "selected"   ? QString()  // a choice of the mesh
                                                    : QString::fromStdString(one.label));
    }
    offerPresets(filter, mesh, labels);
    applyAnew(accurate, kKeepOriginalLabel);
    endPreviewOnClose();
    fitDialogOnScreen();
    if (sliders.isEmpty()) return;
    useOctaves(sliders, size, [mesh](int i, double length) {
        return QString::fromStdString(
            spectral::equalizerLabel(static_cast<std::size_t>(i), length, mesh.diagonal));
    });
}

bool differInSliders(const spectral::Filter& filter, const spectral::Values& one,
                     const spectral::Values& other) {
    return std::all_of(filter.parameters.begin(), filter.parameters.end(),
                       [&](const Parameter& parameter) {
                           return isSlider(filter, parameter) ||
                                  one.at(parameter.name) == other.at(parameter.name);
                       });
}

NumberLabels numberLabels(const spectral::Filter& filter) {
    NumberLabels labels;
    for (const Parameter& one : filter.parameters) {
        const QString label = QString::fromStdString(one.label);
        if (one.kind == Kind::Integer) labels.integers.push_back(label);
        if (one.kind == Kind::Integer || (one.kind == Kind::Number && !isSlider(filter, one)))
            labels.all.push_back(label);
    }
    return labels;
}

spectral::Values valuesOf(const spectral::Filter& filter, const RichParameterList& parameters) {
    spectral::Values values;
    for (const Parameter& one : filter.parameters) {
        const QString name = QString::fromStdString(one.name);
        spectral::Value& value = values[one.name];
        switch (one.kind) {
            case Kind::Bool: value = parameters.getBool(name); break;
            case Kind::Integer: value = parameters.getInt(name); break;
            case Kind::Number:
                value = static_cast<double>(isSlider(filter, one) ? parameters.getDynamicFloat(name)
                                                                  : parameters.getFloat(name));
                break;
            case Kind::Length: value = static_cast<double>(parameters.getAbsPerc(name)); break;
            case Kind::Choice: value = parameters.getEnum(name); break;
            case Kind::Text: value = parameters.getString(name).toStdString(); break;
        }
    }
    return values;
}
