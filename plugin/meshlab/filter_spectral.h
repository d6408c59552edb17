#pragma once

#include <common/plugins/interfaces/filter_plugin.h>

#include <QPointer>
#include <QWidget>
#include <atomic>
#include <mutex>
#include <optional>
#include <vector>

#include "meshlab/mesh_filter.h"

/// The plugin as MeshLab sees it: describes the filters and runs them.
///
/// Every filter reads the parameters and the mesh, calls the core, and writes the result only after
/// the whole computation has succeeded.
class FilterSpectralPlugin : public QObject, public FilterPlugin {
    Q_OBJECT
    MESHLAB_PLUGIN_IID_EXPORTER(FILTER_PLUGIN_IID)
    Q_INTERFACES(FilterPlugin)

  public:
    FilterSpectralPlugin();

    QString pluginName() const override;
    QString vendor() const override;
    QString filterName(ActionIDType filter) const override;
    QString pythonFilterName(ActionIDType filter) const override;
    QString filterInfo(ActionIDType filter) const override;
    FilterClass getClass(const QAction* action) const override;
    int getRequirements(const QAction* action) override;
    int getPreConditions(const QAction* action) const override;
    int postCondition(const QAction* action) const override;
    FilterArity filterArity(const QAction* action) const override;
    RichParameterList initParameterList(const QAction* action, const MeshModel& mesh) override;

    /// @throws MLException  that says what is wrong and what to do; the mesh is then unchanged.
    std::map<std::string, QVariant> applyFilter(const QAction* action,
                                                const RichParameterList& parameters,
                                                MeshDocument& document,
                                                unsigned int& postConditionMask,
                                                vcg::CallBackPos* callback) override;

  private:
    KeptRun* runKeptFor(QWidget* dialog);
    void checkLayer(const MeshFilter& filter, const MeshModel& mesh) const;
    void showOnly(int mesh);
    const MeshFilter& filterOf(const QAction* action) const;
    std::unique_lock<std::recursive_timed_mutex> waitForOtherThreads();
    void releaseGLContext();
    void logOutput(const spectral::FilterOutput& output, double seconds) const;

    const std::vector<MeshFilter> filters_;  // indexed by ActionIDType
    std::vector<std::atomic<int>> runs_;     // number of runs of each filter so far
    int previewed_ = -1;                     // the layer of the last preview; -1: there was none

    /// The layer whose lengths the open dialog shows.
    struct {
        int id = -1;
        QString label;
        spectral::MeshLengths lengths;
    } shown_;
    KeptRun kept_;               // while the dialog of its filter is open
    QPointer<QWidget> keptFor_;  // that dialog

    /// A preview at work, which takes over values chosen in the meantime if they differ in sliders
    /// alone: what takes long then is the same.
    struct {
        const QAction* action = nullptr;  // null: none is
        spectral::Values given;
        std::optional<spectral::Values> newer;
    } draft_;
    std::recursive_timed_mutex running_;  // recursive: MeshLab's dialog restarts a run within it
};
