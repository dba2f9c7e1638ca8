#include "wavefront.hpp"

namespace raylab {

const TraceKernel kTraceNeon = trace;

}  // namespace raylab
