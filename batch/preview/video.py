"""H.264 films, by PyAV."""

from contextlib import ExitStack
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from av.video.reformatter import ColorPrimaries, ColorRange, Colorspace, ColorTrc

from ...addon.errors import MachineError, UsageError
from ..results import atomically

EXTENSION = ".mp4"

_QUALITY = "18"  # x264's constant rate factor: 18 looks as its source


class Video:
    """An MP4 file that pictures are added to; it is there once the block ends well, whole or not at all."""

    def __init__(self, path: Path, size: tuple[int, int], rate: int) -> None:
        """`size` is width and height, both even; `rate` pictures a second. Raises `UsageError` for another ending."""
        if path.suffix.lower() != EXTENSION:
            raise UsageError(f"{path.name}: a film must end in {EXTENSION}")
        self.path, self._size, self._rate = path, size, rate
        self._stack = ExitStack()

    def __enter__(self) -> "Video":
        with ExitStack() as stack:
            temporary = stack.enter_context(atomically(self.path))
            try:
                self._file = av.open(str(temporary), "w", format="mp4", options={"movflags": "faststart"})
                stack.callback(self._file.close)
                self._stream = self._file.add_stream("libx264", rate=self._rate, options={"crf": _QUALITY})
            except (av.FFmpegError, ValueError) as error:
                raise MachineError(f"cannot write {self.path}: {error}") from None
            codec = self._stream.codec_context
            codec.width, codec.height = self._size
            codec.pix_fmt, codec.time_base = "yuv420p", Fraction(1, self._rate)
            # What an sRGB picture is, as nearly as players know it.
            codec.colorspace, codec.color_range = Colorspace.ITU709, ColorRange.MPEG
            codec.color_primaries, codec.color_trc = ColorPrimaries.BT709, ColorTrc.BT709
            self._stack = stack.pop_all()
        return self

    def add(self, picture: np.ndarray) -> None:
        """Add a picture (H, W, 3) uint8, sRGB-encoded, row 0 at the top."""
        frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
        frame = frame.reformat(format="yuv420p", dst_colorspace=Colorspace.ITU709, dst_color_range=ColorRange.MPEG)
        self._write(frame)

    def _write(self, frame: av.VideoFrame | None) -> None:
        for packet in self._stream.encode(frame):
            self._file.mux(packet)

    def __exit__(self, kind, error, trace) -> None:
        try:
            if kind is None:
                self._write(None)
        finally:
            self._stack.__exit__(kind, error, trace)
