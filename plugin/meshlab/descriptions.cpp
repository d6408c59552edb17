#include "meshlab/descriptions.h"

#include <common/parameters/rich_parameters.h>

#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>

#include "meshlab/dialog.h"
#include "meshlab/mesh_filter.h"

namespace {

/// The submenus of MeshLab's Filters menu that list filters of these classes.
QJsonArray menusOf(FilterPlugin::FilterClass classes) {
    QJsonArray menus;
    if (classes & FilterPlugin::VertexColoring) menus.append("Color Creation and Processing");
    if (classes & FilterPlugin::Smoothing) menus.append("Smoothing, Fairing and Deformation");
    if (classes & (FilterPlugin::Quality | FilterPlugin::Measure))
        menus.append("Quality Measure and Computations");
    return menus;
}

QJsonObject described(const RichParameter& parameter) {
    const auto* choices = dynamic_cast<const RichEnum*>(&parameter);
    return {{"name", parameter.name()},
            {"label", parameter.fieldDescription()},
            {"type", parameter.stringType()},
            {"help", parameter.toolTip()},
            {"is_advanced", parameter.isAdvanced()},
            {"choices", QJsonArray::fromStringList(choices ? choices->enumvalues : QStringList())}};
}

QJsonObject described(const MeshFilter& filter) {
    QJsonArray parameters;
    for (const RichParameter& parameter :
         parametersOf(filter.contract, MeshModel(-1, "", ""), {}, movesVertices(filter)))
        parameters.append(described(parameter));
    return {{"name", QString::fromStdString(filter.contract.name)},
            {"python_name", QString::fromStdString(filter.contract.pythonName)},
            {"menus", menusOf(filter.category)},
            {"help", helpOf(filter.contract)},
            {"parameters", parameters}};
}

QByteArray allDescribed() {
    QJsonArray filters;
    for (const MeshFilter& filter : allMeshFilters()) filters.append(described(filter));
    return QJsonDocument(filters).toJson();
}

}  // namespace

const char* meshlab_spectral_filters() {
    static const QByteArray json = allDescribed();
    return json.constData();
}
