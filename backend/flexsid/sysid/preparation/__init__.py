"""Preparation: what recordings need before anything is estimated from them."""
