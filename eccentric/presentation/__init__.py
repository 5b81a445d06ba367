"""All that a person reads of a result: lines, tables, figures, documents, pages.

    fit_text, fit_json                a Fit: lines and figure, document
    diagnosis_text, diagnosis_json    a Diagnosis
    contest_text                      a Contest: models on the same rows
    html                              a Diagnosis as one HTML page
    arm                               the fit and the diagnosis of an arm: lines, documents
    measurement_text                  a NextMeasurement
    calls_text                        how to call the emitted model of a Diagnosis
    ranges_text                       figures of effects beside their known ranges
    simulation_text                   simulated errors of models
    export_text                       what an export wrote
    plan_text                         a MeasurementPlan
    adaptation                        a Replay
    fleet_html                        what changed in a fleet: page, files

In: results.  Out: text, documents, figures.  A file is imported when one of its names is first used;
`__init__.pyi` lists them.
May import: all rooms below it.
"""

from eccentric.lazy import lazy_names

__getattr__, __dir__ = lazy_names(__name__, __file__)
