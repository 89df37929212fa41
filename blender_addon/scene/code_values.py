# SPDX-License-Identifier: GPL-3.0-or-later
"""The code values of a plate for nodes: a copy of its image or clip, which Blender does not linearize.

The node group needs code values, but an image's node delivers their conversion by the image's color space. So the nodes
that are linearized read a copy whose color space is Non-Color, and the plate itself stays as it is in every editor.
Whatever color space the plate gets later, the nodes are right.

If a file is opened again, Blender returns the first image in the order of names that reads it. So the name of a copy
begins with the name of its plate, and comes behind it.
"""

from collections.abc import Iterator

import bpy

from . import stored_estimate
from .color_management import data_space
from .packed_images import has_own_file, is_painted, pixels_of
from .plates import CODE_VALUES_OF, Datablock, alpha_mode, file_state, mark, short_hash

_READ = "camera_response_read"  # the custom property of a copy with the `file_state` of the plate that it has read


def code_values(plate: Datablock) -> Datablock:
    """Return the copy of a plate whose pixels are code values; one that exists is brought up to date.

    It is an image or a clip like the plate, with the same files. The copy of a packed or painted image is packed.
    """
    earlier = next(_copies(plate), None)
    if earlier is not None and has_own_file(plate) and _is_alike(earlier, plate):
        copy = earlier
        copy.colorspace_settings.name = data_space()  # by this, Blender reads the files again, too
    else:
        copy = _painted_copy(plate) if is_painted(plate) else _file_copy(plate)
        if earlier is not None:
            earlier.user_remap(copy)
            _collection(plate).remove(earlier)
        mark(copy, CODE_VALUES_OF, plate)
    if isinstance(copy, bpy.types.Image):
        copy.use_half_precision = False  # on the GPU, codes above 8 bits would lose up to 0.01 stop
    copy.name = _name_behind(plate)
    copy[_READ] = file_state(plate)
    return copy


def alpha_in_compositor(plate: Datablock) -> str:
    """Return the alpha mode, as in `Image.alpha_mode`, of the code values that the compositor gets.

    Images and clips give them as stored. But Blender multiplies the frames of movies of 8 bits by alpha, even in
    Non-Color; frames of more bits come as stored.
    """
    if plate.source != "MOVIE":
        return alpha_mode(plate) or "STRAIGHT"
    return "STRAIGHT" if is_deep(plate) else "PREMUL"


def is_deep(plate: Datablock) -> bool:
    """Return whether Blender reads a plate to floats, as above 8 bits."""
    if isinstance(plate, bpy.types.Image):
        return plate.is_float
    try:
        image = bpy.data.images.load(bpy.path.abspath(plate.filepath))  # a clip does not say it
    except RuntimeError:  # the file was removed meanwhile
        return False
    is_float = image.is_float
    bpy.data.images.remove(image)
    return is_float


def outdated(plate: Datablock, state: str) -> str:
    """Return that the nodes of a plate show an earlier state of its file, and what to do; else an empty text.

    `state` is the present one, see `plates.file_state`. A missing file comes first; of a sequence, a frame may well be
    missing. For painted images see `is_painted_copy_shown`: only one of the two looks for the copies of a plate.
    """
    if is_painted(plate):
        return ""
    copies = [copy for copy in _copies(plate) if copy.users]
    if not copies:
        return ""
    if getattr(plate, "is_dirty", False):
        return "Its nodes lack the unsaved changes: save or pack it, and apply it as Nodes."
    if not state and has_own_file(plate):
        return "" if plate.source == "SEQUENCE" else "Its file is not found: find it with File, External Data."
    if all(_is_alike(copy, plate) and copy.get(_READ, state) == state for copy in copies):
        return ""
    return "Its nodes show the earlier file until it is applied as Nodes."


def is_painted_copy_shown(plate: Datablock) -> bool:
    """Return whether nodes show an image that was painted in Blender as it was when it was applied.

    Blender does not report painting, and comparing all pixels takes too long for a panel.
    """
    return is_painted(plate) and any(copy.users for copy in _copies(plate))


def pack_with_plates() -> None:
    """Pack the copies of plates that were packed since, and may have no file when opened again; linked ones stay."""
    for plate in {copy.get(CODE_VALUES_OF) for copy in bpy.data.images} - {None, ""}:
        is_packed = plate.packed_file and plate.library is None and not is_painted(plate)
        if is_packed and not all(_is_alike(copy, plate) for copy in _copies(plate)):
            code_values(plate)


def note_files_as_read() -> None:
    """Note, when a scene has been opened, that the copies show the files as they are now: Blender reads them anew."""
    for copy in (*bpy.data.images, *bpy.data.movieclips):
        if _READ in copy and (plate := copy.get(CODE_VALUES_OF)):
            copy[_READ] = file_state(plate)


def _copies(plate: Datablock) -> Iterator[Datablock]:
    """Yield the copies of a plate in its own file: one, unless the user has duplicated it."""
    for copy in _collection(plate):
        if copy.get(CODE_VALUES_OF) == plate and copy.library == plate.library:
            yield copy


def _name_behind(plate: Datablock) -> str:
    """Return the name of a plate's copy, which begins with the plate's name and comes behind it, with a short hash.

    A long name is cut, so that the end fits. The wide tilde then stands where the plate's name goes on, and comes
    behind the letters of all languages.
    """
    most = bpy.types.ID.bl_rna.properties["name"].length_max - 1  # bytes
    name, end = plate.name, f" code values {short_hash(plate)}"
    if len(name.encode() + end.encode()) > most:
        end = f"\N{FULLWIDTH TILDE}{end}"
        name = name.encode()[: most - len(end.encode())].decode(errors="ignore")
    return name + end


def _is_alike(copy: Datablock, plate: Datablock) -> bool:
    """Return whether a copy reads the same files as its plate, or holds a packed file of the same size."""
    if has_own_file(plate):
        return has_own_file(copy) and (copy.filepath, copy.source) == (plate.filepath, plate.source)
    sizes = [image.packed_file.size if image.packed_file else 0 for image in (copy, plate)]
    return sizes[0] == sizes[1]


def _file_copy(plate: Datablock) -> Datablock:
    """Return a copy of an image or clip that is a file, packed or not."""
    copy = plate.copy()
    stored_estimate.remove(copy)
    copy.colorspace_settings.name = data_space()
    return copy


def _painted_copy(image: bpy.types.Image) -> bpy.types.Image:
    """Return a packed copy of an image that was painted in Blender: its 8-bit pixels are code values."""
    copy = bpy.data.images.new(image.name, *image.size, alpha=image.channels == 4)
    copy.colorspace_settings.name = data_space()  # before the pixels, which this would remove
    copy.pixels.foreach_set(pixels_of(image))
    copy.alpha_mode = image.alpha_mode
    copy.update()
    copy.pack()
    copy.reload()  # as stored: the compositor multiplies pixels by alpha that come from no file
    return copy


def _collection(plate: Datablock) -> bpy.types.bpy_prop_collection:
    """Return all images, or all clips."""
    return bpy.data.images if isinstance(plate, bpy.types.Image) else bpy.data.movieclips
