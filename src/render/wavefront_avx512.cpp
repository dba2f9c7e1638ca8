#include "wavefront.hpp"

namespace raylab {

const TraceKernel kTraceAvx512 = trace;

}  // namespace raylab
