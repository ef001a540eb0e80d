"""The score: truths and answers together, one after the other (`outcome`), as rows of bars (`rows`), by family (`families`)."""
