"""What `import eccentric` offers besides the rooms' own readers: fit, diagnose, emit and bench, with results.

    inputs      logs, rigs and models as a user has them      -> those of the rooms
    described   describe_log -> LogDescription
    drafted     draft_rig -> RigDraft;  check_rig -> RigCheck
    fitted      fit        -> FitResult; FrictionRegressor: an estimator of scikit-learn
    diagnosed   diagnose   -> DiagnosisResult
    of_arms     fit_arm, diagnose_arm  -> ArmFitResult, ArmDiagnosisResult
    compared    compare    -> CompareResult; simulate -> SimulateResult
    planned     plan       -> PlanResult; plan_detection -> DetectionPlanResult
    emitted     emit       -> files; export -> ExportResult, files
    adapted     adapt      -> AdaptResult
    simulated   bench      -> BenchResult;  bench_arm -> ArmBenchResult;  bench_fleet -> files
    fleet       diagnose_fleet -> FleetResult
    tables      ResultTable, LabelledMatrix, Correlation: for a terminal, a notebook, and data frames
    result      the members of every result

In: paths, tables in memory, mappings. Out: results with named fields, `summary()`, `table()`, `plot()`,
`to_json()`. It may import every room; it decides and computes nothing that belongs to a room. A file is
imported when one of its names is first used; `__init__.pyi` lists them.
"""

from eccentric.lazy import lazy_names

__getattr__, __dir__ = lazy_names(__name__, __file__)
