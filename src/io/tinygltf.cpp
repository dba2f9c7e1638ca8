// All that tinygltf compiles.
#include <fstream>  // which it needs without files too
#define TINYGLTF_IMPLEMENTATION
#include "tinygltf.hpp"
