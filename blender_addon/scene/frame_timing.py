# SPDX-License-Identifier: GPL-3.0-or-later
"""When an image sequence shows which of its files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import bpy

from .node_links import compositor_trees
from .plates import Datablock, datablock_of_node

#: What shows an image and knows the frames of a sequence: an editor's, or a compositor's Image node itself.
ImageUser: TypeAlias = bpy.types.ImageUser | bpy.types.CompositorNodeImage


@dataclass(frozen=True)
class FrameTiming:
    """When an image sequence shows which file.

    Parameters
    ----------
    duration : int
        The number of frames.
    start : int
        The frame of the scene that shows the first one.
    offset : int
        Is added to the frame within the sequence, 1 for the first one, to get the number of the file.
    is_cyclic : bool
        Whether it starts again after its end.
    """

    duration: int
    start: int
    offset: int
    is_cyclic: bool = False

    @classmethod
    def of_user(cls, user: ImageUser) -> FrameTiming:
        """Return the timing that an editor or a node has."""
        return cls(user.frame_duration, user.frame_start, user.frame_offset, user.use_cyclic)

    @classmethod
    def by_number(cls, frames: Sequence[int]) -> FrameTiming:
        """Return the timing that shows every file on the frame of its number."""
        return cls(frames[-1] - frames[0] + 1, frames[0], frames[0] - 1)

    def set_on(self, user: ImageUser) -> None:
        """Give it to an editor or a node."""
        user.frame_duration, user.frame_start, user.frame_offset = self.duration, self.start, self.offset
        user.use_cyclic = self.is_cyclic


def timing_of(context: bpy.types.Context, plate: Datablock, frames: Sequence[int]) -> FrameTiming | None:
    """Return the timing of a plate where it is shown already, in the active editor, another one or a node.

    Where it is shown nowhere, every file is shown on the frame of its number.

    Parameters
    ----------
    context : Context
        Its editor comes first.
    plate : Image or MovieClip
        The plate.
    frames : sequence of int
        The numbers of its files; empty for a single file, which has no timing, as clips, which keep their own.
    """
    if not frames or not isinstance(plate, bpy.types.Image):
        return None
    user = next((user for user in _users(context, plate) if user.frame_duration > 1), None)  # 1: nobody has set it
    return FrameTiming.by_number(frames) if user is None else FrameTiming.of_user(user)


def _users(context: bpy.types.Context, plate: bpy.types.Image) -> Iterator[ImageUser]:
    """Yield what shows an image and may have set its timing: editors, then nodes."""
    areas = [area for screen in bpy.data.screens for area in screen.areas]
    for space in (context.space_data, *(area.spaces.active for area in areas)):
        if space is not None and space.type == "IMAGE_EDITOR" and space.image == plate:
            yield space.image_user
    for tree in compositor_trees():
        yield from (node for node in tree.nodes if node.type == "IMAGE" and datablock_of_node(node) == plate)
