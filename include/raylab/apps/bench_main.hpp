#pragma once

namespace raylab {

/// The whole of `raylab-bench`: parses the command line, measures, writes the results. Returns the exit code as
/// render_main() does. A program of one's own that calls it measures the accelerators registered in that program.
int bench_main(int argc, char** argv);

}  // namespace raylab
