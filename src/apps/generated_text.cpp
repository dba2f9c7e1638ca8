#include "generated_text.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "raylab/core/error.hpp"

namespace raylab {

namespace {

/// An option as a page or a shell presents it.
struct Choice {
  std::vector<std::string> names;  ///< with their dashes, or the one name of an argument without
  std::string description;
  std::string takes;                ///< such as TEXT, INT in [1 - 64] or {x,y,z}; empty for a flag
  std::vector<std::string> values;  ///< those of a set
  std::string default_value;
  bool is_argument = false;
  bool is_many = false;     ///< an argument that may be given more than once
  bool takes_file = false;  ///< or other text that no set limits
};

Choice describe(const CLI::Option& option) {
  Choice choice;
  choice.is_argument = !option.nonpositional();
  for (const std::string& name : option.get_snames()) choice.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) choice.names.push_back("--" + name);
  if (choice.is_argument) choice.names.push_back(option.get_name(true));
  choice.description = option.get_description();
  choice.default_value = option.get_default_str();
  choice.is_many = option.get_items_expected_max() > 1;
  if (option.get_items_expected_max() == 0) return choice;
  const std::string type = option.get_type_name();  // TEXT, INT:INT in [1 - 64], TEXT:{x,y,z}
  choice.takes = type.substr(type.find(':') + 1);
  choice.takes_file = choice.takes == "TEXT" || choice.takes == "OUT";
  if (choice.takes.starts_with("{")) {
    choice.values = CLI::detail::split(choice.takes.substr(1, choice.takes.find('}') - 1), ',');
  }
  return choice;
}

/// All that --help lists, in its order.
std::vector<Choice> choices_of(const CLI::App& app) {
  std::vector<Choice> choices;
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty()) choices.push_back(describe(*option));
  }
  return choices;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) { return app.get_subcommands(nullptr); }

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

std::string escaped(const std::string& text, const std::string& special) {
  std::string out;
  for (const char c : text) {
    if (special.find(c) != std::string::npos) out += '\\';
    out += c;
  }
  return out;
}

/// In single quotes, as bash and zsh read them.
std::string shell_quoted(const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; }

std::string joined(const std::vector<std::string>& words) { return CLI::detail::join(words, " "); }

// --- man ---------------------------------------------------------------------------------------------------

/// Text of a line of roff: a hyphen stays one that can be searched for and copied; no line starts a request.
std::string roff(const std::string& text) {
  const std::string line = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  return line.starts_with(".") || line.starts_with("'") ? "\\&" + line : line;
}

std::string man_choices(const CLI::App& app) {
  std::string page;
  for (const Choice& choice : choices_of(app)) {
    page += ".TP\n\\fB" + roff(CLI::detail::join(choice.names, ", ")) + "\\fR";
    if (!choice.is_argument && !choice.takes.empty()) page += " \\fI" + roff(choice.takes) + "\\fR";
    page += "\n" + roff(choice.description) + "\n";
    if (!choice.default_value.empty()) page += "(default: " + roff(choice.default_value) + ")\n";
  }
  return page;
}

std::string man_synopsis(const CLI::App& app, const std::string& name) {
  std::string line = ".B " + roff(name) + "\n[\\fIOPTIONS\\fR]";
  if (!commands_of(app).empty()) line += " \\fICOMMAND\\fR ...";
  for (const Choice& choice : choices_of(app)) {
    if (choice.is_argument) line += " \\fI" + roff(choice.names.front()) + "\\fR";
  }
  return line + "\n";
}

std::string man_page(const CLI::App& app) {
  const std::string& name = app.get_name();
  std::string title = name;
  std::transform(title.begin(), title.end(), title.begin(), [](char c) { return 'a' <= c && c <= 'z' ? c - 32 : c; });
  std::string summary = app.get_description();
  if (summary.ends_with(".")) summary.pop_back();
  std::string page = ".TH " + roff(title) + " 1 \"\" \"Raylab " RAYLAB_VERSION "\" \"User Commands\"\n.SH NAME\n" +
                     roff(name) + " \\- " + roff(summary) + "\n.SH SYNOPSIS\n" + man_synopsis(app, name);
  page += ".SH OPTIONS\n" + man_choices(app);
  if (!commands_of(app).empty()) page += ".SH COMMANDS\n";
  for (const CLI::App* command : commands_of(app)) {
    page += ".SS " + roff(command->get_name()) + "\n" + roff(command->get_description()) + "\n.PP\n" +
            man_synopsis(*command, name + " " + command->get_name()) + man_choices(*command);
  }
  if (!app.get_footer().empty()) page += ".SH NOTES\n.nf\n" + roff(app.get_footer()) + "\n.fi\n";
  page +=
      ".SH EXIT STATUS\n0: done; 1: failure; 2: usage; 3: bad scene or input; 4: output could not be written; "
      "130: interrupted, with what was done so far written.\n";
  std::string others;
  for (const char* other : {"raylab-bench", "raylab-image", "raylab-preview", "raylab-render"}) {
    if (name != other) others += (others.empty() ? "" : ",\n") + (".BR " + roff(other)) + " (1)";
  }
  return page + ".SH SEE ALSO\n" + others + "\n";
}

// --- bash --------------------------------------------------------------------------------------------------

std::string bash_function_name(const CLI::App& app) { return "_" + replaced(app.get_name(), "-", "_"); }

/// The lines of two case statements: options of a command, and values after one of its options.
void add_bash_cases(const CLI::App& app, const std::string& command, std::string& options, std::string& values) {
  std::vector<std::string> names;
  for (const Choice& choice : choices_of(app)) {
    if (choice.is_argument) continue;
    std::string pattern;
    for (const std::string& name : choice.names) {
      names.push_back(name);
      pattern.append(pattern.empty() ? "'" : " | '").append(command).append(" ").append(name).append("'");
    }
    if (choice.takes.empty()) continue;
    values += "    " + pattern + ") ";
    if (choice.takes_file) {
      values += "compopt -o default 2>/dev/null; return ;;\n";
    } else {
      values += "values='" + joined(choice.values) + "' ;;\n";
    }
  }
  options += "    '" + command + "') options='" + joined(names) + "' ;;\n";
}

std::string bash_completion(const CLI::App& app) {
  std::string options, values, commands;
  add_bash_cases(app, "", options, values);
  for (const CLI::App* command : commands_of(app)) {
    add_bash_cases(*command, command->get_name(), options, values);
    commands += (commands.empty() ? "" : " ") + command->get_name();
  }
  std::string text = R"(# Completions of PROGRAM for bash, made by: PROGRAM --generate bash
FUNCTION() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
  local command='' commands='COMMANDS' options='' values='none' word
  COMPREPLY=()
  # bash parts --option=value in three.
  if [[ $current == = ]]; then
    current=''
  elif [[ $previous == = ]]; then
    previous=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  for word in "${COMP_WORDS[@]:1:COMP_CWORD - 1}"; do
    if [[ " $commands " == *" $word "* ]]; then
      command=$word
      break
    fi
  done
  case "$command $previous" in
VALUES  esac
  if [[ $values != none ]]; then
    # The last of values that commas part.
    word=${current##*,}
    mapfile -t COMPREPLY < <(compgen -P "${current%"$word"}" -W "$values" -- "$word")
    return
  fi
  case $command in
OPTIONS  esac
  if [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current")
  elif [[ -n $commands && -z $command ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$commands" -- "$current")
  else
    compopt -o default 2>/dev/null
  fi
}
complete -F FUNCTION PROGRAM
)";
  text = replaced(text, "FUNCTION", bash_function_name(app));
  text = replaced(text, "PROGRAM", app.get_name());
  text = replaced(text, "COMMANDS", commands);
  text = replaced(text, "VALUES", values);
  return replaced(text, "OPTIONS", options);
}

// --- zsh ---------------------------------------------------------------------------------------------------

/// One call of _arguments.
std::string zsh_arguments(const CLI::App& app, const std::string& indent) {
  std::string text = indent + "_arguments -s -S";
  int argument = 0;
  for (const Choice& choice : choices_of(app)) {
    const std::string values = !choice.values.empty() ? "(" + joined(choice.values) + ")"
                               : choice.takes_file    ? "_files"
                                                      : " ";
    if (choice.is_argument) {
      text +=
          " \\\n" + indent + "  " +
          shell_quoted((choice.is_many ? "*" : std::to_string(++argument)) + ":" + choice.names.front() + ":_files");
      continue;
    }
    for (const std::string& name : choice.names) {
      std::string spec = "*" + name;
      if (!choice.takes.empty() && name.starts_with("--")) spec += "=";
      spec += "[" + escaped(choice.description, "\\[]:") + "]";
      if (!choice.takes.empty()) spec += ":value:" + values;
      text += " \\\n" + indent + "  " + shell_quoted(spec);
    }
  }
  return text;
}

std::string zsh_completion(const CLI::App& app) {
  const std::string& name = app.get_name();
  std::string text =
      "#compdef " + name + "\n# Completions of " + name + " for zsh, made by: " + name + " --generate zsh\n";
  if (commands_of(app).empty()) return text + zsh_arguments(app, "") + "\n";
  text += "local curcontext=$curcontext state line\n" + zsh_arguments(app, "") +
          " \\\n  '1:command:->command' '*::argument:->argument'\ncase $state in\n  command)\n    local -a commands=(";
  for (const CLI::App* command : commands_of(app)) {
    text += "\n      " + shell_quoted(command->get_name() + ":" + escaped(command->get_description(), "\\:"));
  }
  text += ")\n    _describe command commands\n    ;;\n  argument)\n    case $line[1] in\n";
  for (const CLI::App* command : commands_of(app)) {
    text += "      " + command->get_name() + ")\n" + zsh_arguments(*command, "        ") + "\n        ;;\n";
  }
  return text + "    esac\n    ;;\nesac\n";
}

// --- fish --------------------------------------------------------------------------------------------------

std::string fish_quoted(const std::string& text) { return "'" + escaped(text, "\\'") + "'"; }

std::string fish_options(const CLI::App& app, const std::string& begin) {
  std::string text;
  for (const Choice& choice : choices_of(app)) {
    if (choice.is_argument) continue;
    text += begin;
    for (const std::string& name : choice.names) {
      text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    }
    if (choice.takes_file) text += " -r -F";
    if (!choice.takes.empty() && !choice.takes_file) text += " -x";
    if (!choice.values.empty()) text += " -a " + fish_quoted(joined(choice.values));
    text += " -d " + fish_quoted(choice.description) + "\n";
  }
  return text;
}

std::string fish_completion(const CLI::App& app) {
  const std::string begin = "complete -c " + app.get_name();
  std::string text = "# Completions of " + app.get_name() + " for fish, made by: " + app.get_name() +
                     " --generate fish\n" +
                     fish_options(app, begin + (commands_of(app).empty() ? "" : " -n __fish_use_subcommand"));
  for (const CLI::App* command : commands_of(app)) {
    const std::string& name = command->get_name();
    text.append(begin).append(" -n __fish_use_subcommand -f -a ").append(name).append(" -d ");
    text.append(fish_quoted(command->get_description())).append("\n");
    std::string within = begin;
    text += fish_options(*command, within.append(" -n '__fish_seen_subcommand_from ").append(name).append("'"));
  }
  return text;
}

}  // namespace

std::string generated_text(const CLI::App& app, const std::string& kind) {
  if (kind == "man") return man_page(app);
  if (kind == "bash") return bash_completion(app);
  if (kind == "zsh") return zsh_completion(app);
  if (kind == "fish") return fish_completion(app);
  throw Error(ErrorKind::usage, "--generate", "found \"" + kind + "\", expected man, bash, zsh or fish");
}

}  // namespace raylab
