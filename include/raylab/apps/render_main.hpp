#pragma once

namespace raylab {

/// The whole of `raylab-render`: parses the command line, renders, reports. Returns the exit code: 0 done, 1 failure,
/// 2 usage, 3 bad scene or input, 4 output could not be written, 130 interrupted. A program of one's own that calls
/// it offers the accelerators registered in that program (see RegisterAccelerator).
int render_main(int argc, char** argv);

}  // namespace raylab
