#include <raylab/apps/render_main.hpp>

int main(int argc, char** argv) { return raylab::render_main(argc, argv); }
