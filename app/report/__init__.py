"""Reports: tables and plots of experiments, designs and models, as one HTML file that needs no network."""
