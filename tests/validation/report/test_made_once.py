"""What a report asks of a model and its data is made once, whichever of its parts asks first."""

from validation import study
from validation.report import page


def test_a_report_makes_spectra_once_and_fits_all_parameters_once(series, monkeypatch):
    counted = {"predictions": 0, "evaluate": 0, "fit": 0}

    def counting(name):
        of = getattr(study, name)

        def called(*given, **more):
            counted[name] += 1
            return of(*given, **more)

        monkeypatch.setattr(study, name, called)

    for name in counted:
        counting(name)
    monkeypatch.setattr(page, "assembled", lambda *given, **more: more["diagnosis"])
    assert page.reported(page.ReportOptions(compared=series.asked), quiet=True) is not None
    assert counted == {"predictions": 1, "evaluate": 1, "fit": 0}  # the diagnosis takes the fit of the comparison
