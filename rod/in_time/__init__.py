"""An arm in time: inertia, rubber that relaxes, air that is compressed; the elements are those of `rod.arm`."""
