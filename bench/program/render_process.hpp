#pragma once
// Runs of raylab-render as processes of their own, as its users run it.
#include <filesystem>
#include <string>
#include <vector>

#include "suite.hpp"

namespace raylab::bench {

/// The raylab-render to run: the one given, or the one beside this program. Throws Error (usage) when it is not
/// there.
std::string find_render_program(const std::string& given);

/// Arguments of raylab-render for a scene rendered with the variant: its own size and samples where width and spp
/// are 0, its keys overridden.
std::vector<std::string> render_arguments(const std::string& scene_file, const Variant& variant,
                                          const ProcessOptions& options);

/// Renders once to `picture`. Returns what raylab-render --stats tells of it, and `process_seconds`, the
/// wall-clock seconds from the process's start to its end, and `process_cpu_seconds` of all its threads. Throws Error
/// (failure) when it fails.
Row run_render_process(const std::string& program, std::vector<std::string> arguments,
                       const std::filesystem::path& picture);

/// The row of a suite about some such runs of one scene, alike but for their times: what was rendered, the times
/// of the runs, and the error that raylab-render estimates.
Row render_process_row(const std::string& suite, const std::string& scene_file, const Variant& variant,
                       const ProcessOptions& options, const std::vector<Row>& runs);

/// Median and range of a field of such runs, and of the ratios of two fields of neighbouring runs.
Spread spread_of_field(const std::vector<Row>& runs, const char* field);
Spread spread_of_ratios(const std::vector<Row>& numerators, const std::vector<Row>& denominators, const char* field);

}  // namespace raylab::bench
