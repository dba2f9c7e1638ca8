#pragma once
// The scenes made in code, by short names.
#include "raylab/measure/made_scenes.hpp"

namespace raylab::test {
using namespace raylab::made;
}  // namespace raylab::test
