"""Friction models of drives that swing an unbalanced mass: derived, emitted, compared with measured data.

    read_log, read_rig    a file or a table in memory; a file or a mapping     -> Log, Rig
    describe_log          what a file is, and what was understood of it         -> LogDescription
    draft_rig, check_rig  logs -> RigDraft; logs, rig -> RigCheck: all that is wrong at once
    fit                   logs, rig -> FitResult: estimates with uncertainty, held-out error
    diagnose              logs, rig -> DiagnosisResult: what the model lacks, and the extended model
    fit_arm, diagnose_arm the same for every joint of an arm                    -> ArmFitResult, ...
    compare               logs, rig, models -> CompareResult: their errors on the same rows
    simulate              logs, rig, models -> SimulateResult: their motion against the measured one
    plan                  logs, rig, limits -> PlanResult: the motion that would decide what is open
    plan_detection        rig, limits -> DetectionPlanResult: what would show friction by F_N, without a log
    load_model, emit      a derivation -> Model; a Model -> NumPy module and C99 files
    export                a Model or a fit -> files of a simulator  -> ExportResult
    compile               a Model -> a Python module whose functions are the emitted C
    adapt                 a log through the emitted estimator of friction      -> AdaptResult
    bench                 a virtual test bench: log, rig and truth             -> BenchResult
    bench_arm             the same for an arm, on MuJoCo                       -> ArmBenchResult
    diagnose_fleet        logs of many joints over months -> FleetResult: what changed where
    bench_fleet           a small fleet to try it on                           -> files

Bad input raises InputError, with a message of one line. Everything is imported when it is first used.

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
    follow    channels + fit           -> coefficients over time        (adaptation)
    watch     logs of a fleet          -> what changed, joint by joint  (fleet)
    export    Model -> a simulator's model                         (exports)
    run       Model -> its C           -> a Python module               (compiled)
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
