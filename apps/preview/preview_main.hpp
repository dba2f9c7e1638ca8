#pragma once

namespace raylab {

/// The whole of `raylab-preview`. Returns the exit code: 0 left, 1 failure such as no display, 2 usage, 3 bad
/// scene, 4 a file that could not be written.
int preview_main(int argc, char** argv);

}  // namespace raylab
