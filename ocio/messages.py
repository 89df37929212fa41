"""Every sentence that the errors of `ocio` say, each once, by its code; see `crfnet_core.messages` for the rules."""

from collections.abc import Mapping

SENTENCES: Mapping[str, str] = {
    # pipeline: which files there are, and whether they may be written
    "all_in_output": "{path}: all photographs lie in the output folder; choose another one",
    "empty_folder": "{path}: the folder holds no photograph ({suffixes}); check the name",
    "file_exists": "{path}: exists already; choose another folder",
    "file_not_written": "{path}: cannot be written ({reason}); check the file",
    "files_exist": "{path}: {name} and {more} more exist already; choose another folder",
    "folder_for_photograph": "{path}: is a folder; give one photograph, or the frames of a shot ({pattern})",
    "folder_in_place": "{path}: is a folder, and a file of that name is to be written; choose another folder",
    "folder_not_written": "{path}: cannot be written to ({reason}); choose another folder",
    "no_response_in_file": "{path}: holds no response; give the JSON of an estimate or of a calibration, or a LUT",
    "no_such_file": "{path}: there is no such file; check the name",
    "not_a_file_name": "{name} cannot be the name of a file; give one without slashes, such as eos20d",
    "not_a_folder": "{path}: is not a folder; choose another for the output",
    "not_opened": "{path}: cannot be opened ({reason}); check its name",
    "not_writable": "{path}: is not writable; choose another folder for the output",
    "one_name": "{first} and {second} would both be written as {name}; rename one",
    "one_name_elsewhere": "{first} and {second} would be written as {name} and {other}, one name on macOS and Windows;"
    " rename one",
    "replaces_photograph": "{path}: is one of the photographs and would be replaced; choose another folder",
    "variables_in_path": "{path}: OpenColorIO takes $ and % in it for variables and finds no LUT; choose another"
    " folder",
    "written_meanwhile": "{path}: was written by another process meanwhile; choose another folder",
    # pipeline: many photographs
    "movie_in_batch": "{path}: is a movie; linearize it by itself",
    "no_dask": "a scheduler needs Dask: pip install 'crfnet[cluster]'",
    "no_scheduler": "{address}: no Dask scheduler answers there ({reason}); check the address",
    "not_records": "{path}: holds other lines than records of photographs; choose another folder",
    "other_options": "{path}: has {photo} with other options or another response; give the same, or choose another"
    " folder",
    "photographs_failed": "{failed} of {count} photographs failed; the first: {problem}",
    "photographs_failed_of_many": "{failed} of {count} photographs failed and the others are written; the first:"
    " {problem}",
    "process_died": "a process died, perhaps for lack of memory; run the same again",
    "unreadable": "{path}: {reason}",
}
