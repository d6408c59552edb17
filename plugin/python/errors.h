#pragma once

namespace spectral::python {

/// Lets the core's errors arrive as the classes of meshlab_spectral.errors, with `code` and
/// `limit`.
void translateErrors();

}  // namespace spectral::python
