"""The data: responses and scenes, where they come from, and how they are split.

manifest          compares a data folder with `manifest.csv`: source, licence, split and SHA-256 of every file
splits            which scenes and curves are held out: `splits.json`
scenes            scene-linear photographs
linear_files      reads camera raw, OpenEXR and Radiance HDR
import_scenes     adds photographs of your own to the scenes
curves            responses to draw from: DoRF, in-camera base curves, mixtures
dorf              converts DoRF's own text
families          draws responses of the families that are not measured: edited, film, linear, log
in_camera         a distribution of the responses that cameras render with, fitted to measured ones
response_bank     computes the bank of responses that `crfnet_core` ships
real_photographs  photographs of measured cameras, and their responses
emor_basis        computes the EMoR basis that `crfnet_core` ships
"""
