#include "meshlab/filter_spectral.h"

#include <common/ml_shared_data_context/ml_plugin_gl_context.h>
#include <common/ml_shared_data_context/ml_scene_gl_shared_data_context.h>

#include <QApplication>
#include <QDockWidget>
#include <QRegularExpression>
#include <chrono>
#include <cmath>
#include <functional>
#include <iomanip>
#include <sstream>
#include <utility>

#include "core/support/errors.h"
#include "core/support/memory.h"
#include "core/support/threads.h"
#include "meshlab/dialog.h"
#include "meshlab/host_workarounds/apply_anew.h"
#include "meshlab/host_workarounds/apply_lock.h"
#include "meshlab/host_workarounds/filter_dialog.h"
#include "meshlab/host_workarounds/last_messages.h"
#include "meshlab/host_workarounds/late_close.h"
#include "meshlab/host_workarounds/late_preview.h"
#include "meshlab/host_workarounds/number_fields.h"
#include "meshlab/host_workarounds/signals.h"

namespace {

/// Wraps MeshLab's callback in a Progress that also stops once `isWanted` returns false.
spectral::Progress meshlabProgress(vcg::CallBackPos* callback, std::function<bool()> isWanted,
                                   spectral::Progress::Interruption isOvertaken) {
    if (callback == nullptr) return {};
    const auto report = [callback, isWanted = std::move(isWanted)](double fraction,
                                                                   const std::string& stage) {
        return callback(static_cast<int>(100.0 * fraction), stage.c_str()) && isWanted() &&
               !isInterruptedBySignal();
    };
    return spectral::Progress(report, std::move(isOvertaken));
}

/// @throws MLException  when a field of the open dialog holds no number; MeshLab would take it for
/// 0.
void checkFields(const spectral::Filter& filter) {
    const NumberLabels labels = numberLabels(filter);
    const QString field = fieldWithoutNumber(labels.all, labels.integers);
    if (!field.isEmpty()) throw MLException(field + " is not a number that can be used here");
}

[[noreturn]] void refuseVariable(const char* variable, const char* wanted) {
    throw spectral::InvalidOption(std::string("the environment variable ") + variable + " = " +
                                  qgetenv(variable).toStdString() + ": give a number of " + wanted +
                                  ", or unset it");
}

/// The number of threads that the environment asks for; 0: none.
/// @throws spectral::InvalidOption  when it is not above zero.
int environmentThreads() {
    constexpr const char* kVariable = "MESHLAB_SPECTRAL_THREADS";
    if (!qEnvironmentVariableIsSet(kVariable)) return 0;
    bool isNumber = false;
    const int number = qEnvironmentVariableIntValue(kVariable, &isNumber);
    if (!isNumber || number <= 0) refuseVariable(kVariable, "threads above zero");
    return number;
}

/// The limit of memory in the environment, in bytes; 0: none. 4GB is 4 * 2^30, as in the shell.
/// @throws spectral::InvalidOption  when it is not above zero, or infinite.
double environmentMemory() {
    constexpr const char* kVariable = "MESHLAB_SPECTRAL_MEMORY";
    if (!qEnvironmentVariableIsSet(kVariable)) return 0.0;
    static const QRegularExpression size("^(.*?)\\s*([KMGT]?)(i?B)?$",
                                         QRegularExpression::CaseInsensitiveOption);
    const QRegularExpressionMatch match = size.match(qEnvironmentVariable(kVariable).trimmed());
    const QString unit = match.captured(2).toUpper();
    const int power = unit.isEmpty() ? 0 : 1 + QString("KMGT").indexOf(unit);
    const double number = std::ldexp(match.captured(1).toDouble(), 10 * power);
    if (!(number > 0.0 && std::isfinite(number)))
        refuseVariable(kVariable, "bytes above zero, such as 4e9 or 4GB");
    return number;
}

/// The report as pymeshlab returns it. Only these types reach Python; strings do not.
std::map<std::string, QVariant> dictionaryOf(const spectral::Values& report) {
    std::map<std::string, QVariant> dictionary;
    for (const auto& [name, value] : report) {
        if (std::holds_alternative<std::string>(value)) continue;
        QVariant& entry = dictionary[name];
        if (const auto* vector = std::get_if<Eigen::VectorXd>(&value))
            entry = QVariant::fromValue(*vector);
        else if (const auto* number = std::get_if<double>(&value))
            entry = *number;
        else if (const auto* integer = std::get_if<int>(&value))
            entry = *integer;
        else
            entry = std::get<bool>(value);
    }
    return dictionary;
}

}  // namespace

FilterSpectralPlugin::FilterSpectralPlugin() : filters_(allMeshFilters()), runs_(filters_.size()) {
    for (std::size_t i = 0; i < filters_.size(); ++i) {
        typeList.push_back(static_cast<ActionIDType>(i));
        actionList.push_back(new QAction(QString::fromStdString(filters_[i].contract.name), this));
    }
}

// A plugin has one log and one GL context, whose owner MeshLab and pymeshlab change without a lock:
// runs in several threads would write to each other's.
std::unique_lock<std::recursive_timed_mutex> FilterSpectralPlugin::waitForOtherThreads() {
    constexpr std::chrono::milliseconds kBetweenSignals{50};
    std::unique_lock<std::recursive_timed_mutex> lock(running_, std::defer_lock);
    while (!lock.try_lock_for(kBetweenSignals))
        if (isInterruptedBySignal()) throw MLException(spectral::Cancelled().what());
    return lock;
}

// Kept until the dialog is hidden: MeshLab does not delete it before the next one opens.
KeptRun* FilterSpectralPlugin::runKeptFor(QWidget* dialog) {
    auto* dock = qobject_cast<QDockWidget*>(dialog);
    if (dock == nullptr) return nullptr;
    if (keptFor_ != dock) {
        kept_ = {};
        connect(dock, &QDockWidget::visibilityChanged, this, [this](bool isVisible) {
            if (!isVisible) kept_ = {};
        });
        keptFor_ = dock;
    }
    return &kept_;
}

// A dialog stays open when another layer becomes current; its lengths are those of the layer
// before.
void FilterSpectralPlugin::checkLayer(const MeshFilter& filter, const MeshModel& mesh) const {
    const QWidget* dialog = openFilterDialog();
    if (dialog == nullptr || shown_.id == mesh.id() || shown_.id < 0 ||
        dialog->windowTitle() != QString::fromStdString(filter.contract.name))
        return;
    const MeshMatrices matrices = toMatrices(mesh.cm);
    const spectral::MeshLengths lengths = spectral::lengthsOf(matrices.V, matrices.F);
    if (lengths.diagonal == shown_.lengths.diagonal && lengths.meanEdge == shown_.lengths.meanEdge)
        return;
    throw MLException("the dialog has the sizes of layer \"" + shown_.label +
                      "\", and the current layer is \"" + nameOf(mesh) +
                      "\": close the dialog and open the filter again, or go back to that layer");
}

// MeshLab restores the layer of a preview when another becomes current, but goes on showing the
// preview.
void FilterSpectralPlugin::showOnly(int mesh) {
    if (previewed_ < 0 || previewed_ == mesh) return;
    for (QWidget* widget : QApplication::allWidgets())
        if (auto* scene = qobject_cast<MLSceneGLSharedDataContext*>(widget)) {
            scene->meshAttributesUpdated(previewed_, true, MLRenderingData::RendAtts(true));
            scene->manageBuffers(previewed_);
        }
    previewed_ = -1;
}

const MeshFilter& FilterSpectralPlugin::filterOf(const QAction* action) const {
    return filters_.at(static_cast<std::size_t>(ID(action)));
}

// What happened, then what to look at, then numbers; line by line, as MeshLab's log joins the lines
// of an entry.
void FilterSpectralPlugin::logOutput(const spectral::FilterOutput& output, double seconds) const {
    std::istringstream lines(output.text);
    std::string line;
    std::ostringstream time;
    time << ". " << std::setprecision(seconds < 100.0 ? 2 : 3) << seconds << " s.";
    if (std::getline(lines, line)) log(line + time.str());
    for (const spectral::Warning& warning : output.warnings)
        if (warning.code != spectral::WarningCode::NothingRemoved)  // the line above says why
            log("  WARNING: " + warning.text);
    while (std::getline(lines, line)) log(line);
}

QString FilterSpectralPlugin::pluginName() const { return "FilterSpectral"; }

QString FilterSpectralPlugin::vendor() const { return "meshlab-spectral"; }

QString FilterSpectralPlugin::filterName(ActionIDType filter) const {
    return QString::fromStdString(filters_.at(static_cast<std::size_t>(filter)).contract.name);
}

QString FilterSpectralPlugin::pythonFilterName(ActionIDType filter) const {
    return QString::fromStdString(
        filters_.at(static_cast<std::size_t>(filter)).contract.pythonName);
}

QString FilterSpectralPlugin::filterInfo(ActionIDType filter) const {
    return helpOf(filters_.at(static_cast<std::size_t>(filter)).contract);
}

FilterPlugin::FilterClass FilterSpectralPlugin::getClass(const QAction* action) const {
    return filterOf(action).category;
}

// None: filters allocate what they write once they have a result.
int FilterSpectralPlugin::getRequirements(const QAction*) { return MeshModel::MM_NONE; }

// None, although filters need faces: the core's message is clearer than "missing items: faces".
int FilterSpectralPlugin::getPreConditions(const QAction*) const { return MeshModel::MM_NONE; }

// MeshLab 2025.07 creates a GL context for every run, which no filter here uses, and leaks it after
// a run from a dialog: 9 MB per preview with software rendering. It accepts a null context.
void FilterSpectralPlugin::releaseGLContext() {
    if (glContext == nullptr) return;
    glContext->removePerViewRenderindData();
    delete glContext;
    glContext = nullptr;
}

int FilterSpectralPlugin::postCondition(const QAction* action) const {
    return filterOf(action).changes;
}

FilterPlugin::FilterArity FilterSpectralPlugin::filterArity(const QAction*) const {
    return SINGLE_MESH;
}

RichParameterList FilterSpectralPlugin::initParameterList(const QAction* action,
                                                          const MeshModel& mesh) {
    const MeshFilter& filter = filterOf(action);
    const MeshMatrices matrices = toMatrices(mesh.cm);
    const spectral::MeshLengths lengths = spectral::lengthsOf(matrices.V, matrices.F);
    adaptDialog(filter.contract, lengths);
    if (hasWindows()) shown_ = {mesh.id(), nameOf(mesh), lengths};
    return parametersOf(filter.contract, mesh, lengths, movesVertices(filter));
}

std::map<std::string, QVariant> FilterSpectralPlugin::applyFilter(
    const QAction* action, const RichParameterList& parameters, MeshDocument& document,
    unsigned int& postConditionMask, vcg::CallBackPos* callback) {
    keepLastMessages({}, {});
    const MeshFilter& filter = filterOf(action);
    if (document.mm() == nullptr)
        throw MLException("there is no mesh: open one, then this filter anew");
    checkFields(filter.contract);
    const auto lock = waitForOtherThreads();
    releaseGLContext();
    const spectral::Values given = valuesOf(filter.contract, parameters);
    if (draft_.action == action && !isApplying() &&
        differInSliders(filter.contract, draft_.given, given)) {
        draft_.newer = given;
        return {};  // the mesh is as it was; the preview at work writes to it
    }
    // MeshLab handles user input in its callback, during this run: the user may switch the preview
    // off, apply the filter, close a window, restart the filter by changing a parameter in preview,
    // or delete the mesh.
    const LatePreview latePreview;
    const ApplyLock applyLock;
    const LateClose lateClose;
    const bool isPreview = latePreview.isOn() && !isApplying();  // now: it ends within the run
    showOnly(document.mm()->id());
    checkLayer(filter, *document.mm());
    if (isPreview) previewed_ = document.mm()->id();
    // Only a dialog restarts a run; runs in other threads wait.
    QWidget* const dialog = openFilterDialog();
    const bool hasDialog = dialog != nullptr;
    std::atomic<int>& latest = runs_.at(static_cast<std::size_t>(ID(action)));
    const auto isOvertaken = [&latest, hasDialog, run = hasDialog ? ++latest : latest.load()] {
        return hasDialog && run != latest;
    };
    const auto isWanted = [&document, &lateClose, mesh = document.mm()->id()] {
        return document.getMesh(mesh) != nullptr && !lateClose.isRequested();
    };
    // The only place that translates core errors. MeshLab terminates on any exception other than
    // MLException and bad_alloc.
    try {
        const spectral::Progress progress = meshlabProgress(callback, isWanted, isOvertaken);
        spectral::setThreadCount(environmentThreads());
        spectral::setMemoryLimit(environmentMemory());
        RunOptions options;
        options.isPreview = isPreview;
        options.kept = runKeptFor(dialog);
        options.isColored = isColoredByDisplacement(parameters);
        if (!isPreview && (isOriginalKept(parameters) || isLayerWanted()))
            options.layers = &document;
        if (isPreview && filter.contract.preview != nullptr) {
            draft_ = {action, given, {}};
            options.newer = [this] { return std::exchange(draft_.newer, {}); };
        }
        const auto noDraft = [this](const void*) { draft_ = {}; };
        const std::unique_ptr<void, decltype(noDraft)> draftEnd(&draft_, noDraft);
        const auto start = std::chrono::steady_clock::now();
        const spectral::FilterOutput output =
            applyTo(*document.mm(), filter, given, options, progress);
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
        postConditionMask = static_cast<unsigned>(changedBy(filter, output, options.isColored));
        logOutput(output, taken.count());
        keepLastMessages(output.summary, output.warnings);
        if (options.layers != nullptr && !isOriginalKept(parameters)) recordOriginalKept(document);
        return dictionaryOf(output.report);
    } catch (const spectral::Cancelled& cancelled) {
        // No message box: the result of the newer run stays, or the user knows why.
        if (isOvertaken()) return {};
        if (isPreview || lateClose.isMeshLeaving())
            log("stopped: the mesh is as it was");
        else
            throw MLException(lateClose.isRequested() ? "stopped: the mesh is as it was"
                                                      : cancelled.what());
        return {};
    } catch (const spectral::Error& error) {
        keepLastError(error);
        throw MLException(QString::fromStdString(error.what()));
    } catch (const std::bad_alloc&) {
        throw MLException(
            "not enough memory for this mesh; choose a smaller basis_size or spectrum = full where "
            "the filter has them, or simplify the mesh ('Simplification: Quadric Edge Collapse "
            "Decimation')");
    } catch (const MLException&) {
        throw;
    } catch (const std::exception& error) {
        throw MLException(QString("unexpected error: ") + error.what());
    }
}

MESHLAB_PLUGIN_NAME_EXPORTER(FilterSpectralPlugin)

#include "moc_filter_spectral.cpp"  // included here to parse MeshLab's headers only once
