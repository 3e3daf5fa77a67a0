"""LeRobot's warning about its video decoder, as one sentence.

LeRobot imports torchcodec whenever it chooses a decoder. Where FFmpeg is missing that fails, and
LeRobot logs the tracebacks of all attempts, a hundred lines, three times in a training.
"""

import logging

LOGGER = "lerobot.utils.import_utils"  # of get_safe_default_video_backend


class OneSentence(logging.Filter):
    """Shortens the warning that torchcodec cannot be loaded, and lets it pass once."""

    shown = False

    def filter(self, record: logging.LogRecord) -> bool:
        """Whether a record is logged; the warning's text is replaced."""
        if "torchcodec" not in record.getMessage():
            return True
        first, self.shown = not self.shown, True
        record.msg = "torchcodec cannot be loaded (no FFmpeg?), so videos are decoded by pyav."
        record.args = ()
        return first


def shorten_decoder_warning() -> None:
    """Shorten the warning from now on, in this process."""
    logging.getLogger(LOGGER).addFilter(OneSentence())
