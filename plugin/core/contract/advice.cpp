#include "core/contract/advice.h"

#include "core/contract/number_text.h"

namespace spectral {

namespace {

const char* const kRemesh =
    "{apply 'Remove Zero Area Faces' or 'Remeshing: Isotropic Explicit Remeshing'|remesh it} first";

const char* const kKeepLargeParts =
    "parts are tiny compared with the mesh: {apply 'Remove Isolated pieces (wrt Diameter)'|remove "
    "them} first";

/// The values that a filter was called with; only its own parameters are recommended.
class Given {
  public:
    Given(const Filter& filter, const Values& given) {
        for (const Parameter& one : filter.parameters) {
            const auto found = given.find(one.name);
            try {
                const Value& value = found != given.end() ? found->second : one.usual;
                values_[one.name] = converted(one, value, {});
            } catch (const InvalidOption&) {
                values_[one.name] = one.usual;
            }
        }
    }

    bool has(const char* name) const { return values_.count(name) > 0; }
    bool isChoice(const char* name, int choice) const {
        return has(name) && std::get<int>(values_.at(name)) == choice;
    }
    double number(const char* name) const { return std::get<double>(values_.at(name)); }

  private:
    Values values_;
};

/// Whether the filter is the equalizer, whose strength depends on its gains alone.
bool isEqualizer(const Given& given) { return given.has("smallest_size"); }

/// Makes any filter change less; empty for those that only measure.
std::string weakerInGeneral(const Given& given) {
    if (isEqualizer(given)) return "choose gains closer to 1";
    return given.has("feature_size") ? "choose a smaller |feature_size|" : "";
}

/// Alternatives to changing the basis size.
std::string basisAlternatives(const Given& given) {
    std::string text;
    if (given.isChoice("boundary", 1)) text += ", or |boundary = free|";
    if (given.has("spectrum")) text += ", or |spectrum = full|";
    return text;
}

/// Remedy for triangles with no area, or almost none.
std::string largerTriangles(const Given& given) {
    // The default Laplacian accepts them and fails only on parts tiny compared with the mesh.
    if (!given.isChoice("laplacian", 1)) return kKeepLargeParts;
    return std::string(
               "choose |laplacian = intrinsic delaunay|, or {apply 'Merge Close Vertices' and "
               "'Remove Duplicate Faces'|merge close vertices and remove duplicate faces}, or ") +
           kRemesh;
}

/// Remedy for a shape that has collapsed during the filter.
std::string stablerFilter(const Given& given) {
    if (given.isChoice("laplacian", 1)) return "choose |laplacian = intrinsic delaunay|";
    if (given.isChoice("basis_update", 0))
        return "a strong filter with |basis_update = full| pinches off thin parts: choose "
               "|basis_update = conformal|";
    const std::string weaker = weakerInGeneral(given);
    return (weaker.empty() ? "" : weaker + ", or ") + kRemesh;
}

/// Remedy for a filter that leaves nothing.
std::string weakerFilter(const Given& given) {
    constexpr double kSmall = 0.01;
    // A high-pass or band-pass stops the largest details; the others pass them.
    const bool isStopped = given.isChoice("filter_type", 1) || given.isChoice("filter_type", 2);
    const char* const name = isStopped ? "stop_gain" : "pass_gain";
    if (!given.has(name) || given.number(name) >= kSmall)
        return weakerInGeneral(given) +
               "; if the triangles are not connected, {apply 'Merge Close Vertices'|merge close "
               "vertices} first";
    return std::string("choose |") + name + " = 1|, which keeps the large details";
}

/// Remedy for a gain that is too steep.
std::string gentlerFilter(const Given& given) {
    if (isEqualizer(given)) return weakerInGeneral(given);
    constexpr double kLarge = 100.0;
    for (const char* const name : {"pass_gain", "stop_gain"})
        if (given.has(name) && given.number(name) > kLarge)
            return std::string("choose a smaller |") + name + "|";
    return std::string(
               "choose a |stop_gain| of 0.05 instead of 0, a lower |order| or a wider band, ") +
           (given.has("spectrum") ? "|response = gaussian|, fewer steps, or |spectrum = truncated|"
                                  : "or |response = gaussian|");
}

std::string remedy(const Error& error, const Given& given) {
    const std::string limit = std::to_string(error.limit());
    switch (error.code()) {
        case ErrorCode::EmptyMesh: return "{load or create a mesh first|give a mesh with some}";
        case ErrorCode::NoFaces:
            return "reconstruct one first{, e.g. with 'Surface Reconstruction: Screened Poisson' "
                   "or 'Surface Reconstruction: Ball Pivoting'|, e.g. with MeshLab's Surface "
                   "Reconstruction: Ball Pivoting}";
        case ErrorCode::NotFinite:
            return "delete them{, e.g. with 'Conditional Vertex Selection' (x != x) and 'Delete "
                   "Selected Vertices'|}";
        case ErrorCode::ValueNotFinite:
            return "{apply 'Per Vertex Quality Function' with abs(q) < 1e30 ? q : 0/0 first, which "
                   "turns them into NaN|give NaN instead}, i.e. no data";
        case ErrorCode::NoData:
            return "{apply a filter that computes qualities first, e.g. 'Per Vertex Quality "
                   "Function'|give a number at some vertices}";
        case ErrorCode::DegenerateTriangles: return largerTriangles(given);
        case ErrorCode::SolverFailed:
        case ErrorCode::SingularMatrix: return kRemesh;
        case ErrorCode::ShapeCollapsed: return stablerFilter(given);
        case ErrorCode::ShrinksToNothing: return weakerFilter(given);
        case ErrorCode::TooManyVertices:
            return "{apply 'Simplification: Quadric Edge Collapse Decimation'|simplify it} first";
        case ErrorCode::OutOfMemory:
            return "simplify it" +
                   (error.limit() > 0 ? " to " + limit + " vertices or fewer" : std::string()) +
                   "{ ('Simplification: Quadric Edge Collapse Decimation')|}, or {memory}";
        case ErrorCode::BasisOutOfMemory:
        case ErrorCode::BasisTooLarge: return "choose at most " + limit + basisAlternatives(given);
        case ErrorCode::BasisTooSmall: return "choose at least " + limit + basisAlternatives(given);
        case ErrorCode::BasisIncomplete:
            return "choose another |basis_size|" + basisAlternatives(given);
        case ErrorCode::TooManyHarmonics:
            return given.has("spectrum") ? "choose a larger |feature_size|, |response = "
                                           "butterworth| with |order = 8|, "
                                           "or |spectrum = truncated| with |reinject_residual|"
                                         : "choose a larger |feature_size|, or |response = "
                                           "butterworth| with |order = 8|";
        case ErrorCode::BoundaryFixesAll: return "choose |boundary = free|";
        case ErrorCode::TooSteep: return gentlerFilter(given);
        case ErrorCode::OptionOutOfRange:
        case ErrorCode::BadIndex:
        case ErrorCode::NoArea:
        case ErrorCode::Cancelled: break;
    }
    return "";
}

}  // namespace

std::string advice(const Error& error, const Filter& filter, const Values& given) {
    return remedy(error, Given(filter, given));
}

Warning accuracyWarning(double accuracy, double errorEstimate) {
    return {WarningCode::Accuracy, "the requested relative accuracy of " + numberText(accuracy, 2) +
                                       " was not reached, the estimated error is " +
                                       numberText(errorEstimate, 2)};
}

Warning accuracyWarning(double accuracy, double errorEstimate, FilterType type) {
    Warning warning = accuracyWarning(accuracy, errorEstimate);
    warning.text +=
        type == FilterType::Custom
            ? ". Choose gains closer to 1"
            : ". Choose a |stop_gain| of 0.05 instead of 0, a lower |order| or a wider band";
    return warning;
}

Warnings residualWarnings(const Eigen::VectorXd& residuals) {
    constexpr double kAccurate = 1e-6;
    Eigen::Index worst = 0;
    if (residuals.size() == 0 || residuals.maxCoeff(&worst) <= kAccurate) return {};
    return {{WarningCode::HarmonicResiduals,
             "the relative residual of " + std::to_string((residuals.array() > kAccurate).count()) +
                 " of " + std::to_string(residuals.size()) + " harmonics is above " +
                 textOf(kAccurate) + ", at most " + numberText(residuals[worst], 2) + " (number " +
                 std::to_string(worst) +
                 "): the mesh has needle triangles, or parts far away. To fix this, " + kRemesh}};
}

}  // namespace spectral
