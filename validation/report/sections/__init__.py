"""The sections of the page, one file each: `html(report, figures)`, empty where there is nothing to say."""
