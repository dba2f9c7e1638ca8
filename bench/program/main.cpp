#include "raylab/apps/bench_main.hpp"

int main(int argc, char** argv) { return raylab::bench_main(argc, argv); }
