#pragma once

#include <QString>

/// Help of "Spectral Filter (Fractional)", as the HTML that MeshLab shows.
QString fractionalFilterHelp();
