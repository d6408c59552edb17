#include "filter_spectral.h"

#include "core/errors.h"
#include "core/fractional_filter.h"
#include "filter_help.h"
#include "filter_parameters.h"
#include "filter_report.h"
#include "mesh_conversion.h"

namespace {

spectral::Progress meshlabProgress(vcg::CallBackPos* callback) {
    if (callback == nullptr) return {};
    return spectral::Progress([callback](double fraction, const std::string& stage) {
        return callback(static_cast<int>(100.0 * fraction), stage.c_str());
    });
}

}  // namespace

FilterSpectralPlugin::FilterSpectralPlugin() {
    typeList = {SpectralFilterFractional};
    for (const ActionIDType filter : types())
        actionList.push_back(new QAction(filterName(filter), this));
}

QString FilterSpectralPlugin::pluginName() const { return "FilterSpectral"; }

QString FilterSpectralPlugin::vendor() const { return "meshlab-spectral"; }

QString FilterSpectralPlugin::filterName(ActionIDType) const {
    return "Spectral Filter (Fractional)";
}

QString FilterSpectralPlugin::pythonFilterName(ActionIDType) const {
    return "apply_coord_spectral_filter_fractional";
}

QString FilterSpectralPlugin::filterInfo(ActionIDType) const { return fractionalFilterHelp(); }

FilterPlugin::FilterClass FilterSpectralPlugin::getClass(const QAction*) const {
    return FilterPlugin::Smoothing;
}

int FilterSpectralPlugin::getRequirements(const QAction*) { return MeshModel::MM_NONE; }

// None, although faces are needed: the core's message says more than "missing items: faces".
int FilterSpectralPlugin::getPreConditions(const QAction*) const { return MeshModel::MM_NONE; }

int FilterSpectralPlugin::postCondition(const QAction*) const {
    return MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL;
}

FilterPlugin::FilterArity FilterSpectralPlugin::filterArity(const QAction*) const {
    return SINGLE_MESH;
}

RichParameterList FilterSpectralPlugin::initParameterList(const QAction*, const MeshModel& mesh) {
    return fractionalFilterParameters(mesh);
}

std::map<std::string, QVariant> FilterSpectralPlugin::applyFilter(
    const QAction*, const RichParameterList& parameters, MeshDocument& document, unsigned int&,
    vcg::CallBackPos* callback) {
    // The one place where the core's errors become MeshLab's. MeshLab ends the program on anything
    // but MLException and bad_alloc.
    try {
        MeshModel& mesh = *document.mm();
        const MeshMatrices input = toMatrices(mesh.cm);
        const spectral::FilterResult result = spectral::fractionalFilter(
            input.V, input.F, fractionalFilterOptions(parameters), meshlabProgress(callback));
        setPositions(input.vertexIndex, result.V, mesh);
        log(reportText(result));
        return reportDictionary(result);
    } catch (const spectral::Error& error) {
        throw MLException(QString::fromStdString(error.what()));
    } catch (const std::bad_alloc&) {
        throw MLException(
            "not enough memory for this mesh; choose a smaller basis_size, or spectrum = full");
    } catch (const MLException&) {
        throw;
    } catch (const std::exception& error) {
        throw MLException(QString("unexpected error: ") + error.what());
    }
}

MESHLAB_PLUGIN_NAME_EXPORTER(FilterSpectralPlugin)
