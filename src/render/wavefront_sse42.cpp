#include "wavefront.hpp"

namespace raylab {

const TraceKernel kTraceSse42 = trace;

}  // namespace raylab
