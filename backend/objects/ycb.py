"""Where the household shapes come from."""

YCB_SOURCE = (
    "Dimensions measured on the YCB Object and Model Set (Calli et al., 'Benchmarking in Manipulation "
    "Research', IEEE RAM 22(3), 2015, doi:10.1109/MRA.2015.2448951), CC BY 4.0; "
    "shape authored for this project"
)
