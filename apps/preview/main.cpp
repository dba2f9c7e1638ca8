#include "preview_main.hpp"

int main(int argc, char** argv) { return raylab::preview_main(argc, argv); }
