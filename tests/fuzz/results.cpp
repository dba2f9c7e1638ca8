// results.json, and what is made of its rows.
#include "raylab/measure/results.hpp"

#include "fuzz.hpp"

using namespace raylab;

RAYLAB_FUZZ(text) {
  fuzz::write("results.json", text);
  fuzz::read_or_tell([] {
    const Results results = read_results(fuzz::folder());
    to_csv(results.rows);
    for (const Row& row : results.rows) row_key(row);
  });
}
