#include "wavefront.hpp"

namespace raylab {

const TraceKernel kTraceAvx2 = trace;

}  // namespace raylab
