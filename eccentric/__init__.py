"""Friction models for drives that swing an unbalanced mass: derive, emit, fit, diagnose.

    read_log, read_rig    a file or a table in memory; a file or a mapping     -> Log, Rig
    describe_log          a log: its format, columns and time                   -> LogDescription
    draft_rig, check_rig  logs -> RigDraft; logs, rig -> RigCheck: all problems at once
    fit                   logs, rig -> FitResult: estimates with uncertainty, held-out error
    diagnose              logs, rig -> DiagnosisResult: the missing effects, and the extended model
    fit_arm, diagnose_arm the same for every joint of an arm                    -> ArmFitResult, ...
    compare               logs, rig, models -> CompareResult: their errors on the same rows
    simulate              logs, rig, models -> SimulateResult: simulated and measured motion
    plan                  logs, rig, limits -> PlanResult: a motion to decide between the candidates
    plan_detection        rig, limits -> DetectionPlanResult: a motion to reveal friction by F_N
    load_model, emit      a derivation -> Model; a Model -> NumPy module and C99 files
    export                a Model or a fit -> simulator files                   -> ExportResult
    compile               a Model -> a Python module that calls the emitted C
    adapt                 a log through the emitted friction estimator          -> AdaptResult
    bench                 a virtual test bench: log, rig and truth             -> BenchResult
    bench_arm             the same for an arm, on MuJoCo                       -> ArmBenchResult
    diagnose_fleet        logs of many joints over months -> FleetResult: which joints changed, and how
    bench_fleet           the logs of a small fleet                             -> files

Bad input raises InputError with a one-line message. Everything is imported on first use.

Inside, each stage has its own packages, called rooms. Imports run one way: a room imports those before it,
through their `__init__`:

    derive    derivations/*.py         first principles -> Model        (model, effects)
    emit      Model -> Program         -> NumPy module, C99             (emission, templates/)
    read      log + rig                -> signals                       (logs, rigs, signals)
    draft     log                      -> a rig file to complete        (drafting)
    fit       signals + Model          -> coefficients, residual        (identification)
    diagnose  residual + effects       -> verdict, extended Model       (diagnosis, joints)
    simulate  fits + a log's input     -> motion, refined parameters    (simulation)
    plan      verdict + limits         -> the next motion               (planning)
    track     channels + fit           -> coefficients over time        (adaptation)
    watch     logs of a fleet          -> which joints changed          (fleet)
    export    Model                    -> a simulator's model           (exports)
    run       Model -> C               -> a Python module               (compiled)
    check     the paper's claims       -> findings, figures             (paper)
    show      results                  -> text, JSON, HTML              (presentation)
    use       all of it                from Python and from a shell     (api, cli)

`virtual_bench` simulates a test bench with its own code.
"""

# Before anything else: sources that are changed from now on are not those of this process.
import eccentric.import_time
from eccentric.lazy import lazy_names
from eccentric.version import __version__

__getattr__, __dir__ = lazy_names(__name__, __file__)
