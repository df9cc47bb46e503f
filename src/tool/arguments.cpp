// SPDX-License-Identifier: MIT
#include "tool/arguments.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "tool/debug_view.h"
#include "tool/lighting_setup.h"
#include "tool/option_kinds.h"

namespace relume {
namespace {

constexpr const char* kExitStatuses =
    "Exit status: 0 done, 1 a check failed, 2 usage, 3 bad or unreadable input,\n"
    "4 no usable device, 5 out of memory or disk, 130 stopped by Ctrl-C.";

void add_lighting(CLI::App& app, LightingOptions& lighting) {
  add_path(app, "--scene", "GLTF", lighting.scene,
           "Edited copy of the scene: its colours, emission and lights");
  add_path(app, "--lights", "JSON", lighting.lights, "Replaces all punctual lights");
  add_path(app, "--materials", "JSON", lighting.materials, "Replaces albedo and emission by material name");
  add_text(
      app, "--sky", "R,G,B|HDR", [&lighting](const std::string& text) { lighting.sky = text; },
      "Radiance in cd/m2, or an equirectangular image");
  add_number(app, "--max-albedo", lighting.max_albedo, kAlbedoOption,
             "Albedos above are clamped (default: as precomputed)");
}

void add_device(CLI::App& app, SolverChoice& solver, bool reference_allowed) {
  const std::string choices = reference_allowed ? "reference|vulkan[:NAME]" : "vulkan[:NAME]";
  const auto take = [&solver, reference_allowed, choices](const std::string& text) {
    const bool named = text.starts_with("vulkan:") && text.size() > 7;
    if (text != "vulkan" && !named && !(reference_allowed && text == "reference")) {
      throw CLI::ValidationError("--device", fmt::format("expected {}, found '{}'", choices, text));
    }
    solver.reference = text == "reference";
    solver.device_name = named ? text.substr(7) : "";
  };
  add_text(app, "--device", choices, take, "Default: vulkan, the fastest device there is");
}

void add_solver(CLI::App& app, SolverChoice& solver, bool reference_allowed) {
  add_device(app, solver, reference_allowed);
  const std::vector<std::string>& kernels = kernel_names();
  add_choice(
      app, "--kernel", kernels, [&solver, &kernels](std::size_t k) { solver.kernel = kernels[k]; },
      "Default: what suits the device; results are the same");
}

class Parser {
 public:
  Parser() : app_("Precomputed radiosity, relit on the GPU.", "relume") {
    app_.require_subcommand(1);
    app_.set_version_flag("--version", std::string("relume ") + RELUME_VERSION);
    app_.footer(kExitStatuses);
    add_precompute();
    add_info_and_check();
    add_solve();
    add_compare();
    add_factors();
    add_export();
    add_chart();
  }

  Result<std::variant<ParsedArguments, HelpText>> parse(int count, const char* const* values) {
    const auto is_first_word = [&](const CLI::App* command) { return command->get_name() == values[1]; };
    if (count > 1 && values[1][0] != '-' && app_.get_subcommands(is_first_word).empty()) {
      return fail(ErrorCode::usage, fmt::format("'{}' is not a command; see relume --help.", values[1]));
    }
    try {
      app_.parse(count, values);
    } catch (const CLI::CallForHelp&) {
      return HelpText{app_.help()};
    } catch (const CLI::CallForVersion& version) {
      return HelpText{std::string(version.what()) + "\n"};
    } catch (const CLI::ParseError& error) {
      return fail(ErrorCode::usage, fmt::format("{}; see relume --help.", error.what()));
    }
    if (export_.matrices.empty() && !export_.glb && export_.debug.empty() && app_.got_subcommand("export")) {
      return fail(ErrorCode::usage,
                  "export: expected --matrices, --glb or --debug, found none; see relume export --help.");
    }
    const bool nowhere =
        (app_.got_subcommand("precompute") && !precompute_.dry_run && precompute_.output.empty()) ||
        (app_.got_subcommand("watch") && watch_.precompute.output.empty());
    if (nowhere) {
      return fail(ErrorCode::usage, "--output is required; see relume --help.");
    }
    store_values(precompute_.options);
    store_values(watch_.precompute.options);
    if (bounces_) solve_.rule = {*bounces_, 0.0};
    return ParsedArguments{chosen(), mode_};
  }

 private:
  CLI::App& add_command(const std::string& name, const std::string& help) {
    CLI::App& command = *app_.add_subcommand(name, help);
    command.add_flag("--json", mode_.json, "One JSON object on standard output, nothing else there");
    command.add_flag("--quiet", mode_.quiet, "No summary, warnings or progress");
    command.footer(kExitStatuses);
    return command;
  }

  void add_precompute() {
    CLI::App& command = add_command("precompute", "Trace a scene once: clusters, lumels and form factors");
    add_precompute_options(command, precompute_);
    command.add_flag("--dry-run", precompute_.dry_run,
                     "Estimate rows, form factors, bytes, time and memory; writes nothing");
    CLI::App& watch = add_command("watch", "Precompute a scene anew whenever it is saved, until Ctrl-C");
    add_precompute_options(watch, watch_.precompute);
  }

  /// An error target chooses for itself, and rounded values would not be reciprocal.
  static void store_values(PrecomputeOptions& options) {
    if (!options.codec && options.error <= 0.0 && !options.reciprocal) options.codec = ValueCodec::unorm16;
  }

  static void add_precompute_options(CLI::App& command, PrecomputeArguments& arguments) {
    PrecomputeOptions& options = arguments.options;
    add_path(command, "SCENE", "", arguments.scene, "glTF scene (.gltf, .glb)")->required();
    add_path(command, "-o,--output", "FILE", arguments.output, "The .relume file to write");
    add_number(command, "--error", options.error, kTargetOption,
               "Target for indirect light in each room, 2% or 0.02; what follows is then chosen from it");
    add_number(command, "--quality", options.quality, kCountOption, "Rays per lumel (default 512)");
    add_number(command, "--sensor-quality", options.sensor_quality, kCountOption,
               "Rays per sensor (default 16 x quality, at least 4096)");
    add_number(command, "--cluster-size", options.cluster_size, kLengthOption, "Default: about 4 k clusters");
    add_number(command, "--texel-size", options.texel_size, kLengthOption, "Default: about 40 k lumels");
    add_path(command, "--sensors", "CSV", arguments.sensors, "Header id,px,py,pz,nx,ny,nz");
    command
        .add_option("--probes", arguments.probes,
                    "Light probes: none, auto (denser where light changes), a grid of this spacing (m), or a "
                    "CSV with header "
                    "id,px,py,pz")
        ->type_name("none|auto|SPACING|CSV");
    add_choice(
        command, "--values,--codec", {"f32", "unorm16", "sqrt8"},
        [&options](std::size_t k) { options.codec = static_cast<ValueCodec>(k); },
        "How form factors are stored (default unorm16; f32 with --reciprocal; as --error asks)");
    add_number(command, "--budget", options.budget, kCountOrZeroOption,
               "Nodes of the cluster trees that 8 neighbouring rows keep (default 0: full rows)");
    add_number(command, "--system-lumels", options.system_lumels, kCountOption,
               "Systems of more lumels are split where little light crosses (default 65536)");
    command.add_flag("--reciprocal", options.reciprocal,
                     "Form factors between clusters obey reciprocity: less noise of rays");
    command.add_flag("--bounds", options.bounds,
                     "Cut rows also tell how they share out what they see of nodes, a fifth to a third more "
                     "bytes, and rows between clusters are finer: solve --bounds is then twice as narrow");
    command.add_flag(
        "--directional", options.directional,
        "Directional lightmaps: also keep where light comes from, 4 bytes more per form factor of "
        "lumels and sensors");
    command.add_flag("--keep-hollows", options.keep_hollows,
                     "Insides of solids count as surfaces: backs of double-sided materials where no light, "
                     "camera, sensor or sky is; they are left out by default");
    add_number(command, "--max-albedo", options.max_albedo, kAlbedoOption,
               "Albedos above are clamped (default 0.95)");
    add_number(command, "--threads", options.threads, kCountOption, "Default: all");
    add_number(command, "--seed", options.seed, kCountOrZeroOption, "Default 0");
    add_number(command, "--max-memory", options.max_memory, kBytesOption,
               "Refused before the long work when it needs more; 500M, 2G");
    command.add_flag("--rows", options.keep_rows,
                     "Also write FILE.rows: what every ray met, about 3 bytes each, for --update");
    add_path(
        command, "--update", "OLD", arguments.update,
        "A model written with --rows: of its rays (OLD.rows) only those that what moved may have changed are "
        "traced again; the result is that of a precompute without. Sizes are those of OLD unless given");
  }

  void add_info_and_check() {
    add_path(add_command("info", "What is in a .relume file"), "FILE", "", info_.file, ".relume file")
        ->required();
    CLI::App& check = add_command("check", "Verify a .relume file");
    add_path(check, "FILE", "", check_.file, ".relume file")->required();
    check.add_flag("--leaks", check_.leaks,
                   "Also measure the light that rows receive from where they cannot see");
  }

  void add_solve() {
    CLI::App& command = add_command("solve", "Relight: lightmaps, tables and pictures");
    add_path(command, "FILE", "", solve_.file, ".relume file")->required();
    add_path(command, "-o,--output", "DIR", solve_.output, "Folder for the results")->required();
    CLI::Option* systems =
        command
            .add_option_function<std::vector<std::string>>(
                "--systems", [this](const std::vector<std::string>& names) { solve_.systems = names; },
                "Load these systems alone; what the others would add is bounded")
            ->type_name("NAME,NAME...")
            ->delimiter(',')
            ->allow_extra_args(false);
    add_number(command, "--missing-radiosity", solve_.missing_radiosity, kRadiosityOption,
               "The most that a surface of a system not loaded has (default: the most of those loaded)");
    add_lighting(command, solve_.lighting);
    add_choice(
        command, "--ktx2", {"rgba16f", "r11g11b10f", "rgb9e5"},
        [this](std::size_t k) { solve_.ktx2 = static_cast<LightmapFormat>(k); },
        "Lightmaps also as .ktx2, for engines to load");
    command
        .add_flag("--bounds", solve_.bounds,
                  "Also between which values the answer lies that rows had before they were cut and stored")
        ->excludes(systems);
    add_path(
        command, "--certify", "FULL", solve_.certify,
        "Also how far the answer is from what full rows give: those of the rays in FILE.rows, or of a file "
        "of the same scene and sizes without budget")
        ->excludes(systems);
    add_solver(command, solve_.solver, true);
    std::vector<std::string> methods{"auto"};
    methods.insert(methods.end(), method_names().begin(), method_names().end());
    solve_.solver.method.reset();
    add_choice(
        command, "--method", methods,
        [this](std::size_t k) {
          solve_.solver.method = k == 0 ? std::nullopt : std::optional(static_cast<Method>(k - 1));
        },
        "How the reference solves (default auto: the fastest that is safe for the scene)");
    CLI::Option* bounces = add_number(command, "--bounces", bounces_, kCountOrZeroOption,
                                      "Exactly this many bounces, or products of another --method");
    CLI::Option* tolerance = add_number(command, "--tolerance", solve_.rule.tolerance, kShareOption,
                                        "Stop at this bound on the relative error (default 1e-5)");
    bounces->excludes(tolerance);
  }

  void add_compare() {
    CLI::App& command = add_command("compare", "The GPU against the reference, per output");
    add_path(command, "FILE", "", compare_.file, ".relume file")->required();
    add_lighting(command, compare_.lighting);
    add_solver(command, compare_.solver, false);
    add_number(command, "--bounces", compare_.bounces, kCountOrZeroOption,
               "Bounces on both sides (default: what the reference needs for 1e-5)");
    add_number(command, "--tolerance", compare_.tolerance, kShareOption,
               "Largest relative error that passes (default 1e-5)");
  }

  void add_factors() {
    CLI::App& command = add_command("factors", "Form factors between the named surfaces of a scene");
    add_path(command, "SCENE", "", factors_.scene, "glTF scene (.gltf, .glb)")->required();
    add_choice(
        command, "--by", {"node", "material"},
        [this](std::size_t k) {
          factors_.grouping = k == 0 ? FactorGrouping::node : FactorGrouping::material;
        },
        "What a surface is (default node)");
    add_number(command, "--rays", factors_.rays, kCountOption,
               "Rays per surface (default: 67 million in all, 65536 to 4 million each)");
    add_number(command, "--seed", factors_.seed, kCountOrZeroOption, "Default 0");
    add_number(command, "--threads", factors_.threads, kCountOption, "Default: all");
  }

  void add_export() {
    CLI::App& command = add_command("export", "Matrices, geometry and debug pictures for other programs");
    add_path(command, "FILE", "", export_.file, ".relume file")->required();
    add_path(command, "-o,--output", "DIR", export_.output, "Folder for the results (default: here)");
    const std::vector<std::string> formats{"mtx", "npz"};
    add_choice(
        command, "--matrices", formats, [this, formats](std::size_t k) { export_.matrices = formats[k]; },
        "Bounce and gather matrix for Matrix Market or SciPy");
    command.add_flag("--glb", export_.glb, "Geometry with lightmap coordinates and the clusters' albedo");
    const std::vector<std::string>& views = debug_view_names();
    const auto take_views = [this, &views](const std::vector<std::string>& names) {
      for (const std::string& name : names) export_.debug.push_back(views[choose("--debug", views, name)]);
    };
    command
        .add_option_function<std::vector<std::string>>(
            "--debug", take_views, "Pictures and a .glb of one property; may be given several times")
        ->type_name(fmt::format("{}", fmt::join(views, "|")))
        ->allow_extra_args(false);
    const auto take_place = [this](const std::string& text) {
      const std::optional<Rgb> place = parse_triple(text);
      if (!place) throw CLI::ValidationError("--at", fmt::format("expected X,Y,Z, found '{}'", text));
      export_.at = *place;
    };
    command
        .add_option_function<std::string>("--at", take_place, "The receiver that --debug form_factors draws")
        ->type_name("X,Y,Z");
    command.footer(debug_view_help() + "\n\n" + kExitStatuses);
  }

  void add_chart() {
    CLI::App& command = add_command("chart", "Speed against error, as charts");
    ChartOptions& options = chart_.options;
    add_path(command, "SCENE", "", chart_.scene, "glTF scene (.gltf, .glb)")->required();
    add_path(command, "-o,--output", "DIR", chart_.output, "Folder for the results")->required();
    command.add_flag("--quick", options.quick, "Fewer points of a coarser model: a minute or two");
    add_number(command, "--texel-size", options.texel_size, kLengthOption,
               "Default: about 40 k lumels, quick 6 k");
    add_number(command, "--cluster-size", options.cluster_size, kLengthOption,
               "Default: about 4 k clusters, quick 1 k");
    add_number(command, "--threads", options.threads, kCountOption, "Of precomputes (default: all)");
    add_device(command, chart_device_, false);
  }

  CommandArguments chosen() {
    const std::string name = app_.get_subcommands().front()->get_name();
    if (name == "precompute") return precompute_;
    if (name == "watch") return watch_;
    if (name == "info") return info_;
    if (name == "check") return check_;
    if (name == "solve") return solve_;
    if (name == "compare") return compare_;
    if (name == "factors") return factors_;
    chart_.options.device_name = chart_device_.device_name;
    if (name == "chart") return chart_;
    return export_;
  }

  CLI::App app_;
  ConsoleMode mode_;
  PrecomputeArguments precompute_;
  WatchArguments watch_;
  InfoArguments info_;
  CheckArguments check_;
  SolveArguments solve_;
  std::optional<std::uint32_t> bounces_;
  CompareArguments compare_;
  FactorsArguments factors_;
  ExportArguments export_;
  ChartArguments chart_;
  SolverChoice chart_device_;
};

}  // namespace

Result<std::variant<ParsedArguments, HelpText>> parse_arguments(int count, const char* const* values) {
  return Parser().parse(count, values);
}

ConsoleMode console_mode(int count, const char* const* values) {
  const auto given = [&](std::string_view flag) {
    return std::find(values, values + count, flag) != values + count;
  };
  return {given("--json"), given("--quiet")};
}

}  // namespace relume
