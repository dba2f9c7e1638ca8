// raylab-bench with two accelerators more: `grid`, and one that does not look at its options.
#include <raylab/accel/accelerator.hpp>
#include <raylab/apps/bench_main.hpp>

using namespace raylab;

static const RegisterAccelerator registered{
    {"careless", "grid, whatever the options",
     [](const Geometry& geometry, const AcceleratorOptions&) { return make_accelerator("grid", geometry); }}};

int main(int argc, char** argv) { return bench_main(argc, argv); }
