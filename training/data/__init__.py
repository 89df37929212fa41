"""What training and evaluation are made from: responses, scenes, and how both are split."""
