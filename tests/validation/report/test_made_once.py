"""What a report asks of a model and its data is made once, whichever of its parts asks first."""

from dataclasses import replace

import numpy as np

from validation import study
from validation.diagnose import diagnose
from validation.identify import request
from validation.report import identify, page, reference
from validation.report.scenes import setups


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
    assert counted == {"predictions": 1, "evaluate": 1, "fit": 1}  # one fit of all parameters, for diagnosis and comparison


def test_a_second_report_identifies_and_draws_nothing_again(report, tmp_path, monkeypatch):
    monkeypatch.setenv("MASSLINE_CACHE", str(tmp_path))
    counted = []

    def counting(module, name, made):
        monkeypatch.setattr(module, name, lambda *given, **how: counted.append(name) or made(given))

    dot = tmp_path / "dot.png"
    dot.write_bytes(b"a picture")
    counting(identify.identify, "identified", lambda given: report.campaigns[0].findings)
    counting(setups, "sensor_map", lambda given: dot)
    counting(reference, "draw", lambda given: dot)
    counting(reference.reference, "reference_table", lambda given: report.articles[0].table)
    whole = ["identified", "sensor_map", "reference_table", "draw"]

    def made():
        counted.clear()
        campaign = report.campaigns[0].campaign
        part = identify.campaign_part(campaign, [campaign], report.model, None, "full-record")
        article = reference.article_part("cuboid", report.model, report.comparison, ())
        assert not part.missing
        assert article.picture is not None
        assert article.picture.png == b"a picture"
        return counted.copy()

    assert made() == whole
    assert made() == []
    assert identify.sensor_map(replace(report.campaigns[0].campaign, source="of/another-day"), []).said.startswith(
        "Sensors of another-day,"
    )
    assert counted == []  # of other records of one set-up the same picture
    monkeypatch.setenv("MASSLINE_CACHE", str(tmp_path / "empty"))
    assert made() == whole


def test_records_that_were_read_before_their_folder_changed_answer_for_themselves_alone(report, tmp_path, monkeypatch):
    monkeypatch.setenv("MASSLINE_CACHE", str(tmp_path))
    new, counted = report.campaigns[0].campaign, []
    name, one = next(iter(new.recordings.items()))
    field = next(key for key, value in vars(one).items() if isinstance(value, np.ndarray) and value.dtype.kind in "fc")
    old = replace(new, recordings={**new.recordings, name: replace(one, **{field: 1.5 * getattr(one, field)})})
    monkeypatch.setattr(identify, "sensor_map", lambda *given: None)
    monkeypatch.setattr(identify.identify, "identified", lambda *given, **how: counted.append(0) or report.campaigns[0].findings)
    for campaign in (old, new, old, new):
        identify.campaign_part(campaign, [campaign], report.model, None, "full-record")
    assert len(counted) == 2


def test_to_look_up_what_was_identified_no_record_is_read_or_told_again(report, tmp_path, monkeypatch):
    monkeypatch.setenv("MASSLINE_CACHE", str(tmp_path))
    campaign, content, read, told = report.campaigns[0].campaign, identify.cache.content, [], []
    monkeypatch.setattr(identify, "sensor_map", lambda *given: None)
    monkeypatch.setattr(identify.cache, "content", lambda paths: content(read.append(path) or path for path in paths))
    monkeypatch.setattr(identify.cache, "digest", lambda arrays, of=identify.cache.digest: told.extend(arrays) or of(arrays))
    monkeypatch.setattr(identify.identify, "identified", lambda *given, **how: report.campaigns[0].findings)
    for _ in range(2):
        identify.campaign_part(campaign, [campaign], report.model, None, "full-record")
    assert {path.name for path in read if path.suffix != ".py"} <= {"campaign.toml"}
    assert told.count("values") <= len(campaign.recordings)


def test_campaigns_that_are_read_already_are_not_read_again_to_identify(report, monkeypatch):
    campaign, read = report.campaigns[0].campaign, []
    monkeypatch.setattr(request.campaign_file, "read", lambda folder, **how: read.append(folder) or campaign)
    monkeypatch.setattr(request, "facts", lambda files, campaign, *, tared: ((), ()))
    asked = request.IdentifyOptions(campaign=campaign.source)
    assert request.ready(asked, at_hand=(campaign,)).request.campaign is campaign
    assert read == []
    request.ready(asked, at_hand=(replace(campaign, recordings={}),))
    assert read == [campaign.source]


def test_a_diagnosis_is_made_once_of_the_same_data_whoever_is_said_to_have_tested(series, tmp_path, monkeypatch):
    monkeypatch.setenv("MASSLINE_CACHE", str(tmp_path))
    opened, made = study.Study.of(*study.read(series.asked), series.asked), []
    monkeypatch.setattr(diagnose, "diagnosed", lambda of, **how: made.append(how["only"]) or "found")

    def asked(of, **how):
        made.clear()
        assert diagnose.diagnosed_once(of, **how) == "found"
        return len(made)

    (campaign,) = opened.campaigns
    assert [asked(opened), asked(opened)] == [1, 0]
    assert asked(replace(opened, campaigns=(replace(campaign, operator="A. Tester", place="Bremen"),))) == 0
    assert asked(opened, only=("force-gain",)) == 1
    assert asked(replace(opened, hold_out=())) == int(bool(opened.hold_out))
    assert asked(replace(opened, model=replace(opened.model, damping_ratio=0.02))) == 1
    name, record = next(iter(campaign.recordings.items()))
    other = replace(campaign, recordings={**campaign.recordings, name: replace(record, values=1.01 * record.values)})
    assert asked(replace(opened, campaigns=(other,))) == 1
